; Thread: passes with G33 along Z from the present Z, in front of the workpiece. X is the radius.
; @X crest of the thread at the present Z, @Z its end, @LEAD mm per revolution (pitch times starts)
; @DEPTH of the thread: above 0 on the outside, below 0 on the inside of the workpiece
; @FIRST depth of the first cut; cut n goes to @FIRST times the square root of n: all take the same chip section
; optional: @ANGLE of the infeed to X in deg, along a flank instead of straight (0)   @SPRING passes at full depth (0)
;           @TAPER change of X from the present Z to the end (0)   @CHAMFER length along Z of the way out (0)
;           @CLEAR distance of the tool on its way back (1 mm)   @STARTS of the thread (1)
%THREADING
#VAR
V.L.ANGLE = 0
V.L.SPRING = 0
V.L.TAPER = 0
V.L.CHAMFER = 0
V.L.CLEAR = 1
V.L.STARTS = 1
V.L.BEGIN = V.A.PROG.Z
V.L.SIDE = SIGN[@Z - V.A.PROG.Z]
V.L.INTO = SIGN[@DEPTH]
V.L.FULL = ABS[@DEPTH]
V.L.CUTS = 0
V.L.CUT = 0
V.L.START = 0
V.L.DOWN = 0
V.L.FROM = 0
V.L.OUT = 0
V.L.SLOPE = 0
V.L.FREE = 0
#ENDVAR
G52
$IF EXIST[@ANGLE]
V.L.ANGLE = @ANGLE
$ENDIF
$IF EXIST[@SPRING]
V.L.SPRING = @SPRING
$ENDIF
$IF EXIST[@TAPER]
V.L.TAPER = @TAPER
$ENDIF
$IF EXIST[@CHAMFER]
V.L.CHAMFER = @CHAMFER
$ENDIF
$IF EXIST[@CLEAR]
V.L.CLEAR = @CLEAR
$ENDIF
$IF EXIST[@STARTS]
V.L.STARTS = @STARTS
$ENDIF
$IF V.L.SIDE == 0
#ERROR [ID=76 PM1="the thread has no length: it begins at its end" PV1=@Z]
$RETURN
$ENDIF
$IF @FIRST <= 0 OR @FIRST > V.L.FULL
#ERROR [ID=76 PM1="depth of the first cut is not above 0 and up to the depth" PV1=@FIRST PV2=V.L.FULL]
$RETURN
$ENDIF
$IF V.L.CHAMFER > 0 AND V.L.CHAMFER <= V.L.FULL
#ERROR [ID=76 PM1="chamfer is not longer than the depth" PV1=V.L.CHAMFER PV2=V.L.FULL]
$RETURN
$ENDIF
V.L.SLOPE = V.L.TAPER / [@Z - V.L.BEGIN]
V.L.FREE = @X + V.L.INTO * [V.L.CLEAR + MAX[0, V.L.INTO * V.L.TAPER]]
V.L.CUTS = CEIL[[V.L.FULL / @FIRST] ** 2 - 0.000001]
V.L.OUT = @Z - V.L.SIDE * V.L.CHAMFER
$IF V.L.INTO < 0
; Inside, the tool leaves the groove towards the turning centre if the thread is broken off; behind the cycle the retract
; of the machine file counts again
#THREAD RETRACT X[V.L.INTO * [V.L.FULL + V.L.CLEAR]]
$ENDIF
G90 G00 X[V.L.FREE]
$FOR V.L.CUT = 1, V.L.CUTS + V.L.SPRING, 1
V.L.DOWN = MIN[@FIRST * SQRT[V.L.CUT], V.L.FULL]
V.L.FROM = V.L.BEGIN - V.L.SIDE * [V.L.FULL - V.L.DOWN] * TAN[V.L.ANGLE]
$FOR V.L.START = 0, V.L.STARTS - 1, 1
G00 Z[V.L.FROM]
X[@X - V.L.INTO * V.L.DOWN + V.L.SLOPE * [V.L.FROM - V.L.BEGIN]] S.OFFSET=360/V.L.STARTS*V.L.START
G33 Z[V.L.OUT] X[@X - V.L.INTO * V.L.DOWN + V.L.SLOPE * [V.L.OUT - V.L.BEGIN]] K[@LEAD]
$IF V.L.CHAMFER > 0
Z[@Z] X[@X + V.L.TAPER]
$ENDIF
G00 X[V.L.FREE]
$ENDFOR
$ENDFOR
Z[V.L.BEGIN] S.OFFSET=0
$IF V.L.INTO < 0
#THREAD RETRACT DEFAULT
$ENDIF
M29
