; P-ERR-20991 iso_speed_negative.nc line 3 column 4 'M3 S-5': speed -5 rpm of spindle S is negative
; dialect iso
M3 S-5
M30
