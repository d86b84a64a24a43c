; P-ERR-21401 contour_open.nc line 2 column 15 '#CONTOUR MODE [DEV PATH_DEV=1': '[' is not closed in its line
#CONTOUR MODE [DEV PATH_DEV=1
