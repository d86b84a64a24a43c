; machine X Z / S
; dialect iso
; facing X
; words of a lathe: largest speed, cutting speed, feed per turn and per minute, drilling with a feed per turn
N10 G18 G90 G0 X40. Z2.
N20 M3 S400
N30 G95 F0.2
N40 G1 Z-10.
N50 G50 S2500
N60 G96 S100
N70 G1 X20. F0.1
N80 X0.5
N90 G50 S1500
N100 G0 X40.
N110 G97 S600
N120 G94 F240. G1 X30.
N130 G95 X20.
N140 M30
