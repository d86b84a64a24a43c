; P-ERR-20726 message_format_at_the_end.nc line 2 column 12 '#MSG ["100 %"]': '%' in the text of a message: there are %d, %f, %s, and %% for a percent sign
#MSG ["100 %"]
M30
