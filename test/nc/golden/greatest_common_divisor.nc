; Euclid's algorithm with MOD, and prime numbers by a sieve.
P1 = 84 P2 = 36
$WHILE P2 != 0
P3 = P1 MOD P2
P1 = P2
P2 = P3
$ENDWHILE
G00 X[P1]
#VAR
P60[20]
#ENDVAR
$FOR P4 = 2, 19, 1
$IF P60[P4] == 0
Y[P4]
$FOR P5 = P4, 19, P4
P60[P5] = 1
$ENDFOR
$ENDIF
$ENDFOR
M30
