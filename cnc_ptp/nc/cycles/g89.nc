; Boring with dwell: G89[depth, retract plane, dwell in s]. Down and up at the feed.
%G89
G90 G00 Z[@P2]
G01 Z[@P1]
G04 [@P3]
G01 Z[@P2]
M29
