; P-ERR-21548 main_spindle_none.nc line 3 column 5 'N10 #MAIN SPINDLE [S2]': #MAIN SPINDLE needs a spindle, this channel has none
; machine X /
N10 #MAIN SPINDLE [S2]
M30
