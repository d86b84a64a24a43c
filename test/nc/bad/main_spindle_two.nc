; P-ERR-21076 main_spindle_two.nc line 3 column 5 'N10 #MAIN SPINDLE [S2, S3]': #MAIN SPINDLE is written #MAIN SPINDLE [name or logical axis number]
; machine X / three
N10 #MAIN SPINDLE [S2, S3]
M30
