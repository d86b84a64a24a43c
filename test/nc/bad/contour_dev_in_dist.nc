; P-ERR-21113 contour_dev_in_dist.nc line 2 column 30 '#CONTOUR MODE [DIST PATH_DEV=1]': PATH_DEV has no meaning in mode DIST of #CONTOUR MODE
#CONTOUR MODE [DIST PATH_DEV=1]
