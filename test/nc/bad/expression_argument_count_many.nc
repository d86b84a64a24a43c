; P-ERR-21403 expression_argument_count_many.nc line 2 column 4 'P1=SIN[1, 2]': SIN takes 1 value, not 2
P1=SIN[1, 2]
M30
