; The outline and the window of a cover with an end mill of 10 mm; the program names the contour, not the path of the tool.
%L OUTLINE (against the clock, from the middle of the front edge)
G01 X60
G03 X70 Y10 R10
G01 Y35
X55 Y50
X45
G02 X25 Y50 R10                            ; a notch for the cable
G01 X10
G03 X0 Y40 R10
G01 Y10
G03 X10 Y0 R10
G01 X30
M29

%L WINDOW (against the clock, from the middle of its front edge)
G01 X54
Y30
G03 X48 Y36 R6
G01 X20
X16 Y32
Y12
X35
M29

%COVER
G90 G17 G71
T1 D1 M6
V.G.WZ_AKT.R = 5                           ; mm
M03 S1200
M8
G92 X-35 Y-25                              ; corner of the cover
G00 X30 Y-20 Z2
$FOR P1 = 1, 2, 1
G01 Z[-2 * P1] F300
G42 G01 X30 Y0 F1200                       ; the tool is to the right of the outline
LL OUTLINE
G40 X30 Y-20
$ENDFOR
G00 Z5
X35 Y22
G01 Z-2 F300
G41 G01 X35 Y12 F1200                      ; and to the left of the window
LL WINDOW
G40 X35 Y22
M9
G00 Z20
M05
M30
