; Stock removal along Z, outside or inside, up to a cylinder or cone. All @D are diameters, also without G51.
; The tool stands at the diameter of the stock, in front of the workpiece, where the cuts begin.
; @DBEGIN, @ZBEGIN where the contour begins   @DEND, @ZEND where it ends, no deeper than it begins
; @CUT largest depth of a cut (in radius)
; optional: @ALLOWANCE that is left on the contour, in radius (0)   @FINISH 1: a cut along the contour itself at the end (0)
;           @CLEAR distance of the tool when it returns (0.5 mm)
%ROUGHING
#VAR
V.L.ALLOWANCE = 0
V.L.FINISH = 0
V.L.CLEAR = 0.5
V.L.STOCK = 0
V.L.FRONT = 0
V.L.SIDE = 0
V.L.BEGIN = @DBEGIN / 2
V.L.END = @DEND / 2
V.L.CUTS = 0
V.L.CUT = 0
V.L.LEVEL = 0
V.L.Z = 0
V.L.BACK = 0
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
; From here on X is the radius; LEVEL, BEGIN, END and STOCK are heights over the turning centre, inside below 0.
V.L.STOCK = V.A.PROG.X
V.L.FRONT = V.A.PROG.Z
V.L.SIDE = SIGN[V.L.STOCK - V.L.BEGIN]
V.L.BACK = SIGN[V.L.FRONT - @ZEND]
V.L.STOCK = V.L.SIDE * V.L.STOCK
V.L.BEGIN = V.L.SIDE * V.L.BEGIN
V.L.END = V.L.SIDE * V.L.END
$IF @CUT <= 0
#ERROR [ID=71 PM1="depth of cut is not above 0" PV1=@CUT]
$RETURN
$ENDIF
$IF V.L.BACK == 0 OR V.L.BACK * [@ZBEGIN - @ZEND] <= 0 OR V.L.BACK * [V.L.FRONT - @ZBEGIN] < 0
#ERROR [ID=71 PM1="the contour does not lead away from the tool" PV1=@ZBEGIN PV2=@ZEND]
$RETURN
$ENDIF
$IF V.L.END < V.L.BEGIN
#ERROR [ID=71 PM1="the contour is deeper at its end than where it begins" PV1=@DBEGIN PV2=@DEND]
$RETURN
$ENDIF
$IF V.L.STOCK < V.L.BEGIN + V.L.ALLOWANCE OR V.L.SIDE == 0
#ERROR [ID=71 PM1="there is no stock at the beginning of the contour" PV1=@DBEGIN]
$RETURN
$ENDIF
V.L.CUTS = CEIL[[V.L.STOCK - V.L.BEGIN - V.L.ALLOWANCE] / @CUT - 0.000001]
$FOR V.L.CUT = 1, V.L.CUTS, 1
V.L.LEVEL = V.L.STOCK + [V.L.BEGIN + V.L.ALLOWANCE - V.L.STOCK] * V.L.CUT / V.L.CUTS
V.L.Z = @ZEND
$IF V.L.LEVEL < V.L.END + V.L.ALLOWANCE
V.L.Z = @ZBEGIN + [V.L.LEVEL - V.L.ALLOWANCE - V.L.BEGIN] / [V.L.END - V.L.BEGIN] * [@ZEND - @ZBEGIN]
$ENDIF
G00 X[V.L.SIDE * V.L.LEVEL]
G01 Z[V.L.Z]
X[V.L.SIDE * [V.L.LEVEL + V.L.CLEAR]] Z[V.L.Z + V.L.BACK * V.L.CLEAR]
G00 Z[V.L.FRONT]
$ENDFOR
; Along the contour: the steps of a cone, then what was left
$FOR V.L.CUT = 0, V.L.FINISH, 1
$IF V.L.CUT == 1
V.L.ALLOWANCE = 0
$ENDIF
$IF V.L.CUT == 1 OR V.L.END > V.L.BEGIN
G00 X[V.L.SIDE * [V.L.BEGIN + V.L.ALLOWANCE]]
G01 Z[@ZBEGIN]
X[V.L.SIDE * [V.L.END + V.L.ALLOWANCE]] Z[@ZEND]
X[V.L.SIDE * [V.L.STOCK + V.L.CLEAR]]
G00 Z[V.L.FRONT]
$ENDIF
$ENDFOR
X[V.L.SIDE * V.L.STOCK]
M29
