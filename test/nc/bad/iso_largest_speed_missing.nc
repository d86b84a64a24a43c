; P-ERR-21723 iso_largest_speed_missing.nc line 5 column 1 'G50': G50 without a speed, as in G50 S2500
; machine X Z / S
; dialect iso
; facing X
G50
M30
