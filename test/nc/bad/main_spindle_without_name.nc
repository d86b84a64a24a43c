; P-ERR-21082 main_spindle_without_name.nc line 3 column 5 'N10 #MAIN SPINDLE [S2]': spindle S has no name of its own (P-CHAN-00007) for use while S2 is the main spindle
; machine X / S S2
N10 #MAIN SPINDLE [S2]
M30
