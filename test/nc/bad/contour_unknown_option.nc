; P-ERR-21615 contour_unknown_option.nc line 2 column 20 '#CONTOUR MODE [DEV PATHDEV=1]': 'PATHDEV=1' is not available in #CONTOUR MODE; its syntax is #CONTOUR MODE [DEV PATH_DEV=0.01 TRACK_DEV=5] or [DIST PRE_DIST=1 POST_DIST=2], ON, OFF
#CONTOUR MODE [DEV PATHDEV=1]
