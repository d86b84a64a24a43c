; P-ERR-21422 domain_logarithm.nc line 2 column 4 'P1=LN[0]': LN of 0 is not defined
P1=LN[0]
M30
