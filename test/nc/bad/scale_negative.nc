; P-ERR-21605 scale_negative.nc line 2 column 11 '#SCALE X2 Y-1': scale -1 of axis Y must be greater than 0
#SCALE X2 Y-1
M30
