; Boring with dwell: G89[depth, retract plane, dwell in s]. Down and up at the feed.
%G89
$IF @P1 >= @P2
#ERROR [ID=89 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
G90 G00 Z[@P2]
G01 Z[@P1]
G04 [@P3]
G01 Z[@P2]
M29
