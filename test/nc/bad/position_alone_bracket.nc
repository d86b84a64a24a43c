; P-ERR-21062 position_alone_bracket.nc line 3 column 18 'N10 S2[M3 REV100 POS90]': a position of spindle S2 (POS) without M19
; machine X / three
N10 S2[M3 REV100 POS90]
M30
