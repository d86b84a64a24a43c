; P-ERR-21594 error_id_large.nc line 2 column 12 '#ERROR [ID=1001]': #ERROR ID=1001 is not within 1 ... 1000
#ERROR [ID=1001]
M30
