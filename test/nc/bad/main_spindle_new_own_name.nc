; P-ERR-21081 main_spindle_new_own_name.nc line 4 column 5 'N20 S2[M3 REV100]': spindle S2 is the main spindle and is programmed as S
; machine X / three
N10 #MAIN SPINDLE [S2]
N20 S2[M3 REV100]
M30
