; P-ERR-21406 expression_number_for_text.nc line 2 column 8 'P1=LEN[5]': a text is needed here, not a number
P1=LEN[5]
M30
