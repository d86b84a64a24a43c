; P-ERR-20836 label_name_twice.nc line 3 column 1 '[A] X2': label [A] twice in main program, first in line 2
[A] X1
[A] X2
M30
