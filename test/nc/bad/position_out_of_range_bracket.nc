; P-ERR-21083 position_out_of_range_bracket.nc line 3 column 5 'N10 S2[M19 POS=-214748.4 REV10]': position -214748.4 deg of spindle S2 is not within ±214748.3647 deg
; machine X / three
N10 S2[M19 POS=-214748.4 REV10]
N90 M30
