; P-ERR-21608 scale_makes_an_ellipse.nc line 3 column 1 'G02 X10 I5 F100': the arc would be an ellipse: axes X and Y have different scales
#SCALE ON X2
G02 X10 I5 F100
M30
