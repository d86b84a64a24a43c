; P-ERR-21615 contour_on_off.nc line 2 column 19 '#CONTOUR MODE ON [OFF]': 'OFF' is not available in #CONTOUR MODE; its syntax is #CONTOUR MODE [DEV PATH_DEV=0.01 TRACK_DEV=5] or [DIST PRE_DIST=1 POST_DIST=2], ON, OFF
#CONTOUR MODE ON [OFF]
