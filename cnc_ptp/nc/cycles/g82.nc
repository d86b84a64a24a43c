; Counterboring: G82[depth, retract plane, dwell in s].
%G82
G90 G00 Z[@P2]
G01 Z[@P1]
G04 [@P3]
G00 Z[@P2]
M29
