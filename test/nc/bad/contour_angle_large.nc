; P-ERR-21112 contour_angle_large.nc line 2 column 26 '#CONTOUR MODE [MAX_ANGLE=181]': MAX_ANGLE=181 must be at most 180
#CONTOUR MODE [MAX_ANGLE=181]
M30
