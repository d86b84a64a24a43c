; P-ERR-21722 iso_largest_speed_beside.nc line 4 column 5 'G18 G50 G96 S100': G50 S100 must be in a block before G96
; dialect iso
; facing X
G18 G50 G96 S100
M30
