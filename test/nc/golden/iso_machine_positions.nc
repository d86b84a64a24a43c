; dialect iso
; tools with_t
; G53 with codes and tools behind and before it: its words are machine positions, the other codes count from the next block on.
G10 L2 P1 Z100
G10 L2 P2 Z200
G10 L2 P7 Y7 Z700
G43 H1 G0 Z1
G53 G49 G0 Z-5
Z1
G43 H1 G53 G0 Z-6
Z1
G53 G55 Z-7
Z1
G54 G53 Z-8
Z1
G53 G54.1 P1 Z-9
Z1
G59.1 G53 Z-10
Y0
G54 Z1
G53 G18 Z-11
Y1
G53 G17 Z-12
Y1 Z1
T2
Z2
G53 Z-13 T3 M6
Z2
G53 G43 H13 G55 G1 Z-14 F600
Z2
M30
