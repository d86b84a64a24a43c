; P-ERR-21615 message_without_bracket.nc line 2 column 6 '#MSG "five"': '"five"' is not available in #MSG; its syntax is #MSG ["text %d %f %s", value, value, text], before it SYN and a receiver
#MSG "five"
M30
