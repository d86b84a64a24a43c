; P-ERR-21818 iso_boring_without_spindle.nc line 3 column 1 'G86 X1 Z-5 R1 F100': G86 stops the spindle and starts it again, but it does not turn: M03 or M04 first
; dialect iso
G86 X1 Z-5 R1 F100
M30
