; dialect iso
; G91: R from the level before the cycle, Z from R; L or K holes in a row; other planes.
G21 G90 G17 G94
M3 S800
G0 X0 Y0 Z10
G91 G99 G81 X5 Y1 R-8 Z-6 F60 L3
X10 K2
G90 X0 Y20
G80
G0 Z10
G91 G98 G81 X4 Y5 Z-0.6 R1.8 L3
G90 G80
G18 G0 X0 Y5 Z0
G99 G81 X10 Z5 Y-3 R1
G80 G19 G0 X8
G98 G82 Y0 Z3 X-2 R2 P.1
G80
M30
