; P-ERR-20155 positioning_twice_bracket.nc line 3 column 12 'N10 S2[M19 M19]': M19 and M19 for spindle S2 in one block
; machine X / three
N10 S2[M19 M19]
M30
