; P-ERR-20642 turn_m19.nc line 6 column 1 'M19 S.POS=90': M19 of spindle S with constant cutting speed (G96); G97 ends it
; facing X
G18 G00 X20
G96 S100 M03
G01 X10 F100
M19 S.POS=90
M30
