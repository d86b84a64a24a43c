; Drilling: G81[depth, retract plane]. Down at the feed, up at rapid speed.
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
%G81
$IF @P1 >= @P2
#ERROR [ID=81 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
G90 G00
V.CYC.LEVEL = @P2
LL TO
G01
V.CYC.LEVEL = @P1
LL TO
G00
V.CYC.LEVEL = @P2
LL TO
M29
