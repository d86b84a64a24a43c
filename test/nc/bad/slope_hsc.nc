; P-ERR-21111 slope_hsc.nc line 3 column 5 'N10 #SLOPE [TYPE=HSC NO_OPT=1]': slope HSC is not available; available are: STEP, TRAPEZ, SIN2
; machine X Y /
N10 #SLOPE [TYPE=HSC NO_OPT=1]
M30
