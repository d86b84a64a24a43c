; P-ERR-21076 slope_wrong_word.nc line 3 column 5 'N10 #SLOPE [TYPE=STEP FAST=1]': #SLOPE is written [TYPE=STEP] or [TYPE=TRAPEZ] or [TYPE=SIN2], or #SLOPE DEFAULT
; machine X Y /
N10 #SLOPE [TYPE=STEP FAST=1]
M30
