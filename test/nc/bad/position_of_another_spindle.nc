; P-ERR-21062 position_of_another_spindle.nc line 3 column 14 'N10 M19 S100 S2.POS=90': a position of spindle S2 (POS) without M19
; machine X / three
N10 M19 S100 S2.POS=90
M30
