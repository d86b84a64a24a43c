; P-ERR-21615 message_receiver.nc line 2 column 6 '#MSG PRINTER ["a"]': 'PRINTER' is not available in #MSG; its syntax is #MSG ["text %d %f %s", value, value, text], before it SYN and a receiver
#MSG PRINTER ["a"]
M30
