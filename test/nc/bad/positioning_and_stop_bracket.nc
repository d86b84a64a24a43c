; P-ERR-20155 positioning_and_stop_bracket.nc line 3 column 10 'N10 S[M5 M19]': M5 and M19 for spindle S in one block
; machine X / three
N10 S[M5 M19]
M30
