; P-ERR-120167 turn_cutting_speed_zero.nc line 3 column 9 'G18 G96 S0 M03': cutting speed S0 of G96 must be greater than 0
; facing X
G18 G96 S0 M03
M30
