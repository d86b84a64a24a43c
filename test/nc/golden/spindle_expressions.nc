; Speeds and positions of two spindles by expressions.
P1 = 1000
S[M3 REV=P1]
S2[M4 REV[P1 / 2]]
G01 X10 F600
S[REV=P1 * 1.5 M3] S2=P1
$FOR P2 = 0, 270, 90
M19 S.POS=P2
G00 X[P2 / 10]
$ENDFOR
S[M5] S2[M5]
M30
