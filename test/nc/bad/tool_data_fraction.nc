; P-ERR-21010 tool_data_fraction.nc line 4 column 5 'N20 D[P1+0.5]': D1.5 must be an integer from 0 to 999999999
; tools milling
N10 P1 = 1
N20 D[P1+0.5]
M30
