%
; dialect iso
O0007 (spindle words in the blocks of cycles)
G21 G90 G94 G54 G80
G0 Z10.
S500 M3 G86 X1. Y0. Z-5. R2. F100.
X5.
G80 M5
G84 X10. Z-8. R2. F125. S100
X20.
G80
M30
%
