; P-ERR-120129 contour_dev_negative.nc line 2 column 29 '#CONTOUR MODE [DEV PATH_DEV=-0.1]': PATH_DEV=-0.1 must be above 0
#CONTOUR MODE [DEV PATH_DEV=-0.1]
M30
