; P-ERR-20396 division_by_cosine.nc line 2 column 6 'P1=10/COS[90]': division by 0
P1=10/COS[90]
M30
