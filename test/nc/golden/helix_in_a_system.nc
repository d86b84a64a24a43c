; Helices in a rotated and shifted system about Z.
#CS ON [50, 20, 5, 0, 0, 30]
G00 X10 Y0 Z0
G01 F900
$FOR P1 = 1, 3, 1
G03 X10 Y0 Z[-P1] I-10
$ENDFOR
G02 X-10 Z0 I-10
#CS OFF
G01 X0 Y0
M30
