; P-ERR-21111 slope_sin2.nc line 3 column 5 'N10 #SLOPE [TYPE=SIN2]': slope SIN2 is not available; available are: STEP, TRAPEZ
; machine X Y /
N10 #SLOPE [TYPE=SIN2]
M30
