; P-ERR-20155 positioning_and_stop.nc line 3 column 9 'N10 M19 M5 S.POS90': M5 and M19 for spindle S in one block
; machine X / three
N10 M19 M5 S.POS90
M30
