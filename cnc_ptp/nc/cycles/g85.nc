; Reaming: G85[depth, retract plane]. Down and up at the feed.
%G85
$IF @P1 >= @P2
#ERROR [ID=85 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
G90 G00 Z[@P2]
G01 Z[@P1]
G01 Z[@P2]
M29
