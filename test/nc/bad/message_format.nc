; P-ERR-20726 message_format.nc line 2 column 8 '#MSG ["%x", 5]': '%x' in the text of a message: there are %d, %f, %s, and %% for a percent sign
#MSG ["%x", 5]
M30
