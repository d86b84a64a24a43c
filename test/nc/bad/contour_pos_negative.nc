; P-ERR-120129 contour_pos_negative.nc line 2 column 29 '#CONTOUR MODE [POS PRE_DIST=-1 X5]': PRE_DIST=-1 must be at least 0
#CONTOUR MODE [POS PRE_DIST=-1 X5]
M30
