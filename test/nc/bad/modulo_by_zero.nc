; P-ERR-20396 modulo_by_zero.nc line 2 column 6 'P1=5 MOD 0': division by 0
P1=5 MOD 0
M30
