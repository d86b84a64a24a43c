; P-ERR-20396 division_by_zero.nc line 3 column 5 'P2=5/P1': division by 0
P1=0
P2=5/P1
M30
