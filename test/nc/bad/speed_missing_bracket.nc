; P-ERR-21036 speed_missing_bracket.nc line 3 column 5 'N20 S2[M04]': M04 of spindle S2 without a speed: none was programmed before
N10 M03 S1000
N20 S2[M04]
M30
