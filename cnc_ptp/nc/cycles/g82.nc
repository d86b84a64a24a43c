; Counterboring: G82[depth, retract plane, dwell in s].
%G82
$IF @P1 >= @P2
#ERROR [ID=82 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
G90 G00 Z[@P2]
G01 Z[@P1]
G04 [@P3]
G00 Z[@P2]
M29
