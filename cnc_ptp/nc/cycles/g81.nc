; Drilling: G81[depth, retract plane]. Down at the feed, up at rapid speed.
%G81
G90 G00 Z[@P2]
G01 Z[@P1]
G00 Z[@P2]
M29
