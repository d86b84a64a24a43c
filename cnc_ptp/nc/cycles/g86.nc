; Boring: G86[depth, retract plane]. The spindle stops before the tool goes up, and turns again after it.
%G86
$IF @P1 >= @P2
#ERROR [ID=86 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
G90 G00 Z[@P2]
G01 Z[@P1]
V.L.TURNS = V.SPDL_PROG.MOVE_CMD.S
M05
G00 Z[@P2]
$IF V.L.TURNS != 5
M[V.L.TURNS]
$ENDIF
M29
