; P-ERR-21081 main_spindle_own_name.nc line 3 column 5 'N10 S1[M3 REV100]': spindle S1 is the main spindle and is programmed as S
; machine X / three
N10 S1[M3 REV100]
M30
