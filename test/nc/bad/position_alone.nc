; P-ERR-21062 position_alone.nc line 3 column 13 'N10 M3 S100 S.POS=90': a position of spindle S (POS) without M19
; machine X / three
N10 M3 S100 S.POS=90
M30
