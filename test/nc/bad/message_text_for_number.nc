; P-ERR-21405 message_text_for_number.nc line 2 column 13 '#MSG ["%d", "a"]': "a" is a text where a number is needed
#MSG ["%d", "a"]
M30
