; Deep drilling: G83[depth, retract plane, peck depth]. Up to the retract plane after each peck.
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
%G83
$IF @P1 >= @P2
#ERROR [ID=83 PM1="depth is not below the retract plane" PV1=@P1 PV2=@P2]
$RETURN
$ENDIF
$IF @P3 <= 0
#ERROR [ID=83 PM1="peck depth is not above 0" PV1=@P3]
$RETURN
$ENDIF
V.L.CLEARANCE = 0.5
V.L.DEPTH = @P2
G90 G00
V.CYC.LEVEL = @P2
LL TO
$WHILE V.L.DEPTH > @P1
G00
V.CYC.LEVEL = MIN[V.L.DEPTH + V.L.CLEARANCE, @P2]
LL TO
V.L.DEPTH = MAX[V.L.DEPTH - @P3, @P1]
G01
V.CYC.LEVEL = V.L.DEPTH
LL TO
G00
V.CYC.LEVEL = @P2
LL TO
$ENDWHILE
M29
