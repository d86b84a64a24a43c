; P-ERR-20991 speed_negative.nc line 2 column 9 'N10 M03 S-1000': speed -1000 rpm of spindle S is negative
N10 M03 S-1000
M30
