; P-ERR-120169 iso_largest_speed_zero.nc line 5 column 1 'G50 S0': largest speed 0 rpm of G50 must be greater than 0
; machine X Z / S
; dialect iso
; facing X
G50 S0
M30
