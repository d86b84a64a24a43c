; P-ERR-21110 slope_unknown.nc line 3 column 5 'N10 #SLOPE [TYPE=SOFT]': slope SOFT is not known; known are: STEP, TRAPEZ, SIN2
; machine X Y /
N10 #SLOPE [TYPE=SOFT]
M30
