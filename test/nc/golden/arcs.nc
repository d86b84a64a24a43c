; arcs in all planes: quarter, three quarters, full, by centre and by radius, helix
%ARCS
N10 G17 G90 G162 F1200
N20 G00 X0 Y0 Z0
N30 G02 X10 Y10 I10 J0        ; quarter, clockwise, about 10, 0
N40 G03 X0 Y0 I0 J-10         ; back, counter-clockwise
N50 G02 X10 Y10 R10           ; the same by radius
N60 G02 X0 Y0 R-10            ; 270 degrees
N70 G03 I5                    ; full circle
N80 G161 G03 I5 J0 Z-3        ; full turn of a helix, centre absolute
N90 G162 G91 G02 X10 Y-10 I10 J0 Z3
N100 G90 X20 Y0 R10           ; radius in a modal block
N110 R20 X0 Y20
N120 G18 G00 X0 Y0 Z0
N130 G03 X10 Z10 R10
N140 G03 Z0 X0 I-10 Y5        ; quarter about Z10, X0, Y alongside
N150 G19 G00 X0 Y0 Z0
N160 G02 Y10 Z10 J10
N170 G03 Y0 Z0 K-10
N180 G17 G02 X3.0001 Y4 I1.5 J2 ; half circle with a rounded centre
N190 M02
