; Drilling: G81[depth, retract plane]. Down at the feed, up at rapid speed.
%G81
$IF @P1 >= @P2
#ERROR [ID=81 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
G90 G00 Z[@P2]
G01 Z[@P1]
G00 Z[@P2]
M29
