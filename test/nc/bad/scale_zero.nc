; P-ERR-21605 scale_zero.nc line 2 column 8 '#SCALE X0': scale 0 of axis X must be greater than 0
#SCALE X0
M30
