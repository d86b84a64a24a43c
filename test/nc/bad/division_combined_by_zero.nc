; P-ERR-20396 division_combined_by_zero.nc line 2 column 8 'P1=5 P1/=0': division by 0
P1=5 P1/=0
M30
