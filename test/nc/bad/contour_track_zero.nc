; P-ERR-120129 contour_track_zero.nc line 2 column 43 '#CONTOUR MODE [DEV PATH_DEV=0.1 TRACK_DEV=0]': TRACK_DEV=0 must be above 0
#CONTOUR MODE [DEV PATH_DEV=0.1 TRACK_DEV=0]
