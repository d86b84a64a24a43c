; A hole: @P1 depth, @P2 retract plane.
%DRILL
G90 G00 Z[@P2]
G01 Z[@P1] F200
G04 0.2
G00 Z[@P2]
M29
