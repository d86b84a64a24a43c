; dialect iso
; tools milling
; H1 is 75 mm with wear of -0.25 mm, H13 41 mm; the length acts in the block of G43, G53 knows none
T1 M6
G0 X1 Y2 Z300
G43 H1 Z50
G1 Z-5 F600
G53 G0 Z200
T3 M6
G43 Z50 H13
G18
Z50
Y50
G17
Z50
G49
G0 Z50
G20
G43 H1 Z1
G43 H0
Z1
M30
