; P-ERR-20642 turn_m19_in_brackets.nc line 4 column 1 'S[M19 POS90]': M19 of spindle S with constant cutting speed (G96); G97 ends it
; facing X
G18 G96 S100 M03
S[M19 POS90]
M30
