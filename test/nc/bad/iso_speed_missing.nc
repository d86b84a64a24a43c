; P-ERR-21036 iso_speed_missing.nc line 3 column 1 'M3': M03 of spindle S without a speed: none was programmed before
; dialect iso
M3
G1 X5 F100
M30
