; P-ERR-21818 iso_boring_stopped.nc line 4 column 4 'M5 G86 X1 Z-5 R1 F100': G86 stops the spindle and starts it again, but it does not turn: M03 or M04 first
; dialect iso
S500 M3
M5 G86 X1 Z-5 R1 F100
M30
