; P-ERR-21608 tilted_ellipse.nc line 5 column 1 'G02 X10 I5 F100': the arc would be an ellipse: axes X and Y have different scales
#CS ON [0, 0, 0, 30, 20]
#SCALE X2
#SCALE ON
G02 X10 I5 F100
M30
