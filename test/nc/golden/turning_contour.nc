; machine X Z / S
; A turned contour with shoulders, fillets and a chamfer, roughed parallel to it in two offsets.
%L CONTOUR
G00 X[8 + @GAP] Z2
G01 Z[-8] F[@FEED]
G02 X[12 + @GAP] Z-12 R4
G01 X[15 + @GAP]
X[17 + @GAP] Z-14
Z-30
G03 X[20 + @GAP] Z-33 R3
G01 Z-45
X[24 + @GAP]
G00 Z2
M29
%SHAFT
G18 G90 G71
M04 S1500
$FOR P1 = 2, 0, -1
LL CYCLE [NAME=CONTOUR @GAP=P1 * 0.75 @FEED=100 + P1 * 40]
$ENDFOR
G00 X60 Z60
M05
M30
