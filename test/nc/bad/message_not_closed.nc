; P-ERR-21401 message_not_closed.nc line 2 column 6 '#MSG ["a"': '[' is not closed in its line
#MSG ["a"
M30
