; tools milling
; a contour in a subroutine, in a loop with a function in each pass; the compensation is still on at the end
%L SIDE
N10 G91 X20
N20 Y20
M29
%MAIN
N10 D1 G00 X-10 Y-20
N20 G42 G01 X0 Y0 F600
N30 $FOR P1 = 1, 2, 1
N40 LL SIDE
N50 M8
N60 $ENDFOR
N70 Z5
M30
