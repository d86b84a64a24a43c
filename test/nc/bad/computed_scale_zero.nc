; P-ERR-21605 computed_scale_zero.nc line 3 column 8 '#SCALE X=P1': scale 0 of axis X must be greater than 0
P1=0
#SCALE X=P1
M30
