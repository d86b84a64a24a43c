; P-ERR-20180 main_spindle_unknown.nc line 3 column 5 'N10 #MAIN SPINDLE [S4]': spindle S4 does not belong to this channel; its spindles are: S, S2, S3
; machine X / three
N10 #MAIN SPINDLE [S4]
M30
