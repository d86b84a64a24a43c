; P-ERR-21113 contour_dist_in_dev.nc line 2 column 29 '#CONTOUR MODE [DEV PRE_DIST=1]': PRE_DIST has no meaning in mode DEV of #CONTOUR MODE
#CONTOUR MODE [DEV PRE_DIST=1]
