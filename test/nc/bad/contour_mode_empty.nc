; P-ERR-21616 contour_mode_empty.nc line 2 column 17 '#CONTOUR MODE []': #CONTOUR MODE without values in brackets, ON or OFF; its syntax is #CONTOUR MODE [DEV PATH_DEV=0.01 TRACK_DEV=5], [DIST PRE_DIST=1 POST_DIST=2] or [POS PRE_DIST=1 POST_DIST=2 X10 Y5], ON, OFF
#CONTOUR MODE []
M30
