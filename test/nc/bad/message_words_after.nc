; P-ERR-21615 message_words_after.nc line 2 column 12 '#MSG ["a"] X5': 'X5' is not available in #MSG; its syntax is #MSG ["text %d %f %s", value, value, text], before it SYN and a receiver
#MSG ["a"] X5
M30
