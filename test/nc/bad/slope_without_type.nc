; P-ERR-21076 slope_without_type.nc line 3 column 5 'N10 #SLOPE': #SLOPE is written [TYPE=STEP] or [TYPE=TRAPEZ] or [TYPE=SIN2], or #SLOPE DEFAULT
; machine X Y /
N10 #SLOPE
M30
