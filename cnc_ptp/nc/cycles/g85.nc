; Reaming: G85[depth, retract plane]. Down and up at the feed.
%G85
G90 G00 Z[@P2]
G01 Z[@P1]
G01 Z[@P2]
M29
