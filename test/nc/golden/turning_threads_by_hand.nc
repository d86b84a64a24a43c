; machine X Z / S
; The passes of a thread with a depth that decreases as the square root: only the approaches, without G33.
M03 S400
G00 X11 Z5
P1 = 1
$WHILE P1 <= 5
P2 = 0.9 * SQRT[P1 / 5]
G00 X[10 - P2]
G01 Z-20 F600
G00 X11
Z5
P1 += 1
$ENDWHILE
M05
M30
