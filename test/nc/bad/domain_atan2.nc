; P-ERR-21422 domain_atan2.nc line 2 column 4 'P1=ATAN2[0,0]': ATAN2 of 0, 0 is not defined
P1=ATAN2[0,0]
M30
