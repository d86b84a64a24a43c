; Stock removal along X, towards the turning centre or away from it, up to a face or cone. All @D are diameters.
; The tool stands beside the stock, at its face: where the cuts begin.
; @DBEGIN, @ZBEGIN where the contour begins, on the side of the tool   @DEND, @ZEND where it ends, no deeper than it begins
; @CUT largest depth of a cut (along Z)
; optional: @ALLOWANCE that is left on the contour, along Z (0)   @FINISH 1: a cut along the contour itself at the end (0)
;           @CLEAR distance of the tool when it returns (0.5 mm)
%FACING
#VAR
V.L.ALLOWANCE = 0
V.L.FINISH = 0
V.L.CLEAR = 0.5
V.L.FACE = 0
V.L.BESIDE = 0
V.L.BACK = 0
V.L.SIDE = 0
V.L.CUTS = 0
V.L.CUT = 0
V.L.LEVEL = 0
V.L.X = 0
#ENDVAR
$IF EXIST[@ALLOWANCE]
V.L.ALLOWANCE = @ALLOWANCE
$ENDIF
$IF EXIST[@FINISH]
V.L.FINISH = @FINISH
$ENDIF
$IF EXIST[@CLEAR]
V.L.CLEAR = @CLEAR
$ENDIF
G52 G90
; From here on X is the radius; SIDE: the stock is at larger (1) or smaller (-1) Z than the contour.
V.L.BESIDE = V.A.PROG.X
V.L.FACE = V.A.PROG.Z
V.L.SIDE = SIGN[V.L.FACE - @ZBEGIN]
V.L.BACK = SIGN[V.L.BESIDE - @DEND / 2]
$IF @CUT <= 0
#ERROR [ID=72 PM1="depth of cut is not above 0" PV1=@CUT]
$RETURN
$ENDIF
$IF V.L.BACK == 0 OR V.L.BACK * [@DBEGIN - @DEND] <= 0 OR V.L.BACK * [V.L.BESIDE - @DBEGIN / 2] < 0
#ERROR [ID=72 PM1="the contour does not lead away from the tool" PV1=@DBEGIN PV2=@DEND]
$RETURN
$ENDIF
$IF V.L.SIDE * [@ZEND - @ZBEGIN] < 0
#ERROR [ID=72 PM1="the contour is deeper at its end than where it begins" PV1=@ZBEGIN PV2=@ZEND]
$RETURN
$ENDIF
$IF V.L.SIDE == 0 OR V.L.SIDE * [V.L.FACE - @ZBEGIN] < V.L.ALLOWANCE
#ERROR [ID=72 PM1="there is no stock at the beginning of the contour" PV1=@ZBEGIN]
$RETURN
$ENDIF
V.L.CUTS = CEIL[[V.L.SIDE * [V.L.FACE - @ZBEGIN] - V.L.ALLOWANCE] / @CUT - 0.000001]
$FOR V.L.CUT = 1, V.L.CUTS, 1
V.L.LEVEL = V.L.FACE + [@ZBEGIN + V.L.SIDE * V.L.ALLOWANCE - V.L.FACE] * V.L.CUT / V.L.CUTS
V.L.X = @DEND / 2
$IF V.L.SIDE * [V.L.LEVEL - @ZEND] < V.L.ALLOWANCE
V.L.X = @DBEGIN / 2 + [V.L.LEVEL - V.L.SIDE * V.L.ALLOWANCE - @ZBEGIN] / [@ZEND - @ZBEGIN] * [@DEND - @DBEGIN] / 2
$ENDIF
G00 Z[V.L.LEVEL]
G01 X[V.L.X]
X[V.L.X + V.L.BACK * V.L.CLEAR] Z[V.L.LEVEL + V.L.SIDE * V.L.CLEAR]
G00 X[V.L.BESIDE]
$ENDFOR
; Along the contour: the steps of a cone, then what was left
$FOR V.L.CUT = 0, V.L.FINISH, 1
$IF V.L.CUT == 1
V.L.ALLOWANCE = 0
$ENDIF
$IF V.L.CUT == 1 OR @ZEND != @ZBEGIN
G00 Z[@ZBEGIN + V.L.SIDE * V.L.ALLOWANCE]
G01 X[@DBEGIN / 2]
X[@DEND / 2] Z[@ZEND + V.L.SIDE * V.L.ALLOWANCE]
Z[V.L.FACE + V.L.SIDE * V.L.CLEAR]
G00 X[V.L.BESIDE]
$ENDIF
$ENDFOR
Z[V.L.FACE]
M29
