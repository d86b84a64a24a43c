; P-ERR-21405 expression_text_for_number.nc line 2 column 1 'P1="five"': the value of P1 is a text where a number is needed
P1="five"
M30
