; P-ERR-21423 modulo_of_decimals.nc line 2 column 4 'P1=5.5 MOD 2': MOD needs an integer, not 5.5
P1=5.5 MOD 2
M30
