; machine X Z C / c_axis
; the main spindle becomes axis C of the path, and a spindle again
N10 M19 S.POS=30 S200
N20 #CAX [S, C]
N30 G01 X10 C90 F1000
N40 G91 C-20
N50 G90 G92 C5
N60 G00 C0 Z5
N70 S2[M3 REV100]
N80 #CAX OFF
N90 M3 S500
N99 M30
