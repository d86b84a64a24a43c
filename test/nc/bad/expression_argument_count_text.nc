; P-ERR-21403 expression_argument_count_text.nc line 2 column 4 'P1=LEN["a", 2]': LEN takes 1 value, not 2
P1=LEN["a", 2]
M30
