; P-ERR-21406 message_number_for_text.nc line 2 column 7 '#MSG [5]': a text is needed here, not a number
#MSG [5]
M30
