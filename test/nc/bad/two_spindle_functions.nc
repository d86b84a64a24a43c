; P-ERR-21012 two_spindle_functions.nc line 2 column 15 'N10 M03 S1000 M05': M03 and M05 belong to one group (spindle) and cannot be in one block
N10 M03 S1000 M05
M30
