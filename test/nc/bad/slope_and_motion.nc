; P-ERR-21075 slope_and_motion.nc line 3 column 5 'N10 X10 #SLOPE [TYPE=STEP]': #SLOPE must be alone in its block, not with 'X10'
; machine X Y /
N10 X10 #SLOPE [TYPE=STEP]
M30
