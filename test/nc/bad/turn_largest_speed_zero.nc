; P-ERR-120169 turn_largest_speed_zero.nc line 3 column 5 'G18 G196 S0': largest speed 0 rpm of G196 must be greater than 0
; facing X
G18 G196 S0
M30
