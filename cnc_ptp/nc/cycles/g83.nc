; Deep drilling: G83[depth, retract plane, peck depth]. Up to the retract plane after each peck.
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
G90 G00 Z[@P2]
$WHILE V.L.DEPTH > @P1
G00 Z[MIN[V.L.DEPTH + V.L.CLEARANCE, @P2]]
V.L.DEPTH = MAX[V.L.DEPTH - @P3, @P1]
G01 Z[V.L.DEPTH]
G00 Z[@P2]
$ENDWHILE
M29
