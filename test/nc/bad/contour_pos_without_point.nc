; P-ERR-21616 contour_pos_without_point.nc line 2 column 31 '#CONTOUR MODE [POS PRE_DIST=1]': #CONTOUR MODE without an interim point (X, Y, Z); its syntax is #CONTOUR MODE [DEV PATH_DEV=0.01 TRACK_DEV=5], [DIST PRE_DIST=1 POST_DIST=2] or [POS PRE_DIST=1 POST_DIST=2 X10 Y5], ON, OFF
#CONTOUR MODE [POS PRE_DIST=1]
M30
