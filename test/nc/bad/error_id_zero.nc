; P-ERR-21594 error_id_zero.nc line 2 column 12 '#ERROR [ID=0]': #ERROR ID=0 is not within 1 ... 1000
#ERROR [ID=0]
M30
