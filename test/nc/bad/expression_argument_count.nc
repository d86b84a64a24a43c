; P-ERR-21403 expression_argument_count.nc line 2 column 4 'P1=ATAN2[1]': ATAN2 takes 2 values, not 1
P1=ATAN2[1]
M30
