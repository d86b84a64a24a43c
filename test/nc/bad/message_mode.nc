; P-ERR-21593 message_mode.nc line 2 column 1 '#MSG SYN_ACK ["a"]': #MSG SYN_ACK waits for an acknowledgement, which is not available yet
#MSG SYN_ACK ["a"]
M30
