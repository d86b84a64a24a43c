; P-ERR-21083 position_out_of_range.nc line 3 column 9 'N10 M19 S.POS=300000': position 300000 deg of spindle S is not within ±214748.3647 deg
; machine X / three
N10 M19 S.POS=300000
N90 M30
