; P-ERR-20836 label_twice.nc line 3 column 1 'N5: X2': label N5 twice in main program, first in line 2
N5: X1
N5: X2
M30
