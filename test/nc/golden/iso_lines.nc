; dialect iso
; Spelling: gaps, lower case, signs, leading zeros, comments, block delete, long block numbers.
%
o0012 (name, of the part)
n000010 g21 g 90 g 017 (first) g094 (second)
/ g0 x1
/2 x2
/9N7X3
N123456789 g01x+1.5y-.5z+0.25f0600(end)
X 2. Y -1. ; to the end of the line
g4 p.5
G04 X1.5
s1000m3
M19 R90
G09 X3
G61 X4
G61.1
g64
G64 P.02
T3
M6
m05
M01
M00

M2
%
text behind the last percent sign # [ is not read
