; Boring with dwell and stop: G88[depth, retract plane, dwell in s]. Spindle and program stop behind the dwell;
; behind the start of the operator the tool goes up, and the spindle turns again.
; It drills along the axis that is normal to the plane: Z with G17, Y with G18, X with G19.
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
%G88
$IF @P1 >= @P2
#ERROR [ID=88 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
G90 G00
V.CYC.LEVEL = @P2
LL TO
G01
V.CYC.LEVEL = @P1
LL TO
G04 [@P3]
V.L.TURNS = V.SPDL_PROG.MOVE_CMD.S
M05
M00
G00
V.CYC.LEVEL = @P2
LL TO
$IF V.L.TURNS != 5
M[V.L.TURNS]
$ENDIF
M29
