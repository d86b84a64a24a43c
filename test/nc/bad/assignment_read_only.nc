; P-ERR-21408 assignment_read_only.nc line 2 column 1 'V.A.ABS.X=5': V.A.ABS can be read only
V.A.ABS.X=5
M30
