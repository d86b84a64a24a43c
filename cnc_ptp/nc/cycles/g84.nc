; Tapping: G84[depth, retract plane, pitch, dwell]. The spindle turns with the path at the last S, and stands afterwards.
; A negative pitch is a left-hand thread.
%G84
$IF @P1 >= @P2
#ERROR [ID=84 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
$IF @P3 == 0
#ERROR [ID=84 PM1="pitch is 0" PV1=@P3]
$RETURN
$ENDIF
M5
G90 G00 Z[@P2]
G331 Z[@P1] K[@P3]
$IF @P4 > 0
G04 [@P4]
$ENDIF
G332 Z[@P2] K[@P3]
M29
