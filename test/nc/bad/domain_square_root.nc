; P-ERR-21422 domain_square_root.nc line 2 column 4 'P1=SQRT[2-3]': SQRT of -1 is not defined
P1=SQRT[2-3]
M30
