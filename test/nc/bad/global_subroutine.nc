; P-ERR-21002 global_subroutine.nc line 2 column 5 'N10 L100': unknown word 'L100'
N10 L100
M30
