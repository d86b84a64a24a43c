; Boring: G86[depth, retract plane]. The spindle stops before the tool goes up, and turns again after it.
%G86
G90 G00 Z[@P2]
G01 Z[@P1]
V.L.TURNS = V.SPDL_PROG.MOVE_CMD.S
M05
G00 Z[@P2]
$IF V.L.TURNS != 5
M[V.L.TURNS]
$ENDIF
M29
