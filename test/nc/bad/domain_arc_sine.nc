; P-ERR-21422 domain_arc_sine.nc line 2 column 4 'P1=ASIN[1.5]': ASIN of 1.5 is not defined
P1=ASIN[1.5]
M30
