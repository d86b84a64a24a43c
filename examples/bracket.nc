; Bracket, 120 x 80 x 10 mm: contour, pocket with helix entry, four drilled holes.
; Zero point: front left corner, top of the blank. All contours are paths of the tool's centre.

%L HOLE
( drill one hole 12 mm deep at the current position: starts and ends 5 mm above the part )
N10 G91 G01 Z-11 F1500
N20 G01 Z-6 F1200
N30 G04 0.25                       ; let the drill clear the bottom
N40 G00 Z17
N50 G90
N60 M29

%L CORNERS
( round the pocket wall once, 50 x 30 with corners of 8 mm, counter-clockwise from its lower edge )
N10 G01 X77
N20 G03 X85 Y33 I0 J8
N30 G01 Y47
N40 G03 X77 Y55 I-8 J0
N50 G01 X43
N60 G03 X35 Y47 I0 J-8
N70 G01 Y33
N80 G03 X43 Y25 R8
N90 G01 X60
N100 M29

%BRACKET
N10 G17 G90 G162                   ; plane XY, absolute, circle centres from the start point
N20 T1 D1                          ; end mill 10 mm
N30 M06
N40 G00 Z50
N50 M03 S4800
N60 G00 X-6 Y-6
N70 M08                            ; coolant on

( outer contour, clockwise, depth 6 mm, corners of 12 mm )
N100 G00 Z2
N110 G01 Z-6 F1200
N120 G01 X0 Y12 F2700
N130 Y68 F3600
N140 G02 X12 Y80 I12 J0
N150 G01 X108
N160 G02 X120 Y68 I0 J-12
N170 G01 Y12
N180 G02 X108 Y0 R12
N190 G01 X12
N200 G02 X0 Y12 I0 J12
N210 G01 X-6 Y18 F4500
N220 G00 Z5

( pocket: helix of three turns down to 6 mm, clearing pass, wall )
N300 G00 X66 Y40
N310 G01 Z0.5 F2400
N320 G03 Z-2 I-6 J0 F1500
N330 G03 Z-4 I-6 J0
N340 G03 Z-6 I-6 J0
N350 G03 I-6 J0                    ; level the bottom
N360 G01 X60 Y40 F2700
N370 G01 X72 Y34
N380 G01 Y46
N390 X48
N400 Y34
N410 X72
N420 G01 X60 Y25 F2400
N430 LL CORNERS
N440 G01 Y40 F4500
N450 G00 Z50
N460 M05 M09

( four holes )
N500 T2 D2                         ; drill 6 mm
N510 M06
N520 S[M03 REV3200]
N530 G04 X0.5
N540 G00 X15 Y15
N550 G00 Z5 M08
N560 LL HOLE
N570 G00 X105
N580 LL HOLE
N590 Y65
N600 LL HOLE
N610 X15
N620 LL HOLE

N700 G00 Z50 M09
N710 S[M05]
N720 G00 X0 Y0
N730 M30
