; P-ERR-21076 slope_default_type.nc line 3 column 5 'N10 #SLOPE DEFAULT [TYPE=STEP]': #SLOPE DEFAULT is written without arguments
; machine X Y /
N10 #SLOPE DEFAULT [TYPE=STEP]
M30
