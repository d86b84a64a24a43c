; Tapping: G84[depth, retract plane, pitch, dwell]. The spindle turns with the path, at the last S, and then as before.
; A negative pitch is a left-hand thread. It taps along the axis that is normal to the plane: Z with G17, Y with G18, X with G19.
%L TO
; To V.CYC.LEVEL in the axis that is normal to the plane.
$SWITCH V.G.PLANE
$CASE 17
Z[V.CYC.LEVEL]
$BREAK
$CASE 18
Y[V.CYC.LEVEL]
$BREAK
$CASE 19
X[V.CYC.LEVEL]
$ENDSWITCH
M29
%G84
$IF @P1 >= @P2
#ERROR [ID=84 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
$IF @P3 == 0
#ERROR [ID=84 PM1="pitch is 0" PV1=@P3]
$RETURN
$ENDIF
V.L.TURNS = V.SPDL_PROG.MOVE_CMD.S
M05
G90 G00
V.CYC.LEVEL = @P2
LL TO
G331 K[@P3]
V.CYC.LEVEL = @P1
LL TO
G04 [@P4]
G332 K[@P3]
V.CYC.LEVEL = @P2
LL TO
G00
$IF V.L.TURNS != 5
M[V.L.TURNS]
$ENDIF
M29
