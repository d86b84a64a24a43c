; P-ERR-21113 contour_off_in_brackets.nc line 2 column 30 '#CONTOUR MODE [OFF TRACK_DEV=1]': TRACK_DEV has no meaning in mode OFF of #CONTOUR MODE
#CONTOUR MODE [OFF TRACK_DEV=1]
M30
