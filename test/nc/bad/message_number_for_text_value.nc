; P-ERR-21406 message_number_for_text_value.nc line 2 column 13 '#MSG ["%s", 5]': a text is needed here, not a number
#MSG ["%s", 5]
M30
