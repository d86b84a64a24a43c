; P-ERR-120129 contour_dev_zero.nc line 2 column 29 '#CONTOUR MODE [DEV PATH_DEV=0]': PATH_DEV=0 must be above 0
#CONTOUR MODE [DEV PATH_DEV=0]
M30
