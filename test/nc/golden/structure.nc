; spelling, comments, block skip, subroutines before the main program
(a line of comment (nested) with X10)
%L POINT
N10 G91 G01 Z-2
N20 Z2 G90
N30 M29

%L row (calls POINT)
G00 X10 LL POINT
X20 LL point
M17

% 100 (main program)
n10g0x0y0z2f600
N20 G00Y=5
/N30 X99
/2 X98
LL ROW
Y15 LL ROW ; behind the motion
N70
N80 G91 X-5.5Y+.5
G90 ( back
X0 Y0
N100M30
