; P-ERR-20991 speed_negative_bracket.nc line 2 column 5 'N10 S2[M03 REV-1000]': speed -1000 rpm of spindle S2 is negative
N10 S2[M03 REV-1000]
M30
