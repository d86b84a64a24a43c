%L LETTER_C
N10 G90 G01 X24.8 F200
N20 G91 G03 Z-8 I-4 J0 F900 ; half a circle
N30 G90 G00 X27
N40 G91 Z8
N50 G90 M29
%L LETTER_N
N10 G90 G01 X24.8 F200
N20 G91 Z-8 F900
N30 Z8 C-6
N40 Z-8
N50 G90 G00 X27
N60 G91 Z8 C6
N70 G90 M29
%CAXIS
; Ends of a turned part of 50 mm diameter with a driven tool: six holes and a hexagon on the face, a wave and the
; letters CNC around it. X is the distance from the centre; the tool of the cylinder works along X.
N10 G00 G90 X40 Z110
N20 M19 S.POS=0 S200
N30 #CAX [S, C]

; six holes on a circle of 40 mm: the C axis alone turns from one to the next
N40 G00 X20
N50 $FOR P1 = 0, 5, 1
N60   G00 C[P1 * 60] Z102
N70   G01 Z92 F300
N80   G00 Z102
N90 $ENDFOR

; a hexagon of 26 mm across its flats, in Cartesian coordinates
N100 G00 X30 C0
N110 #FACE [X, C]
N120 #CONTOUR MODE [DEV PATH_DEV=0.01]
N130 G00 X15.011 C-7
N140 G01 Z98 F200
N150 G261 G01 C0 F800
N160 X7.506 C13
N170 X-7.506
N180 X-15.011 C0
N190 X-7.506 C-13
N200 X7.506
N210 X15.011 C0
N220 G260 C7
N230 G00 Z110
; a groove past the centre: the path slows down there by itself
N240 G00 X12 C0.05
N250 G01 Z99 F200
N260 X-12 F600
N270 G00 Z110
N280 X0 C35

; letters and a wave on the cylinder: Z and the length of arc, 0.2 mm deep
N290 #FACE OFF
N300 G00 X60
N310 Z80 C0
N320 #CYL [Z, C, X25]
N330 LL LETTER_C
N340 G91 G00 C12
N350 G90
N360 LL LETTER_N
N370 G91 G00 C8
N380 G90
N390 LL LETTER_C
N400 G00 Z50 C0
N410 G01 X24.8 F200
N420 $FOR P1 = 1, 5, 1
N430   G91 G02 C15.708 I0 J7.854 F900
N440   G03 C15.708 I0 J7.854
N450 $ENDFOR
N460 G90 G00 X60
N470 #CYL OFF
N480 #CAX OFF
N490 M3 S600
N500 G00 X80 Z150
N510 M5
N520 M30
