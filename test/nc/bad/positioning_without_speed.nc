; P-ERR-21067 positioning_without_speed.nc line 3 column 9 'N10 M19 S0 S.POS90': M19 of spindle S needs a speed above 0, it has 0 rpm
; machine X / three
N10 M19 S0 S.POS90
M30
