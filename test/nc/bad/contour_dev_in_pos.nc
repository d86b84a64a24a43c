; P-ERR-21113 contour_dev_in_pos.nc line 2 column 32 '#CONTOUR MODE [POS X5 PATH_DEV=1]': PATH_DEV has no meaning in mode POS of #CONTOUR MODE
#CONTOUR MODE [POS X5 PATH_DEV=1]
M30
