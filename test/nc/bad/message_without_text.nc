; P-ERR-21616 message_without_text.nc line 2 column 5 '#MSG': #MSG without a text in brackets; its syntax is #MSG ["text %d %f %s", value, value, text], before it SYN and a receiver
#MSG
M30
