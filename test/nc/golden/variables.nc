; Self-defined variables of all scopes, types and arrays, texts.
%L INNER
#VAR
V.L.A = 3
#ENDVAR
G00 X[V.L.A] Y[V.P.A] Z[V.CYC.A]
V.P.A = V.P.A + 1
V.CYC.A = V.CYC.A + 10
V.CYC.B = 5
M29
%VARIABLES
#VAR
V.L.A : SGN32 = 1
V.P.A : REAL64 = 2
V.CYC.A
V.S.A = 4
V.P.FIELD[2][3] = [1, 2, 3, \
                   4, 5, 6]
V.P.NAME : STRING[20] = "left"
#ENDVAR
LL INNER
LL INNER
N10 X[V.L.A] Y[V.P.A] Z[V.CYC.A]
N20 X[V.P.FIELD[1][2]] Y[EXIST[V.CYC.B]] Z[EXIST[V.S.A]]
$IF V.P.NAME == "left"
N30 X-100
$ENDIF
V.P.NAME = LEFT[V.P.NAME, 2] + "ft hand"
$IF V.P.NAME == "left hand"
N40 X[LEN[V.P.NAME]]
$ENDIF
#DELETE V.P.NAME
N50 Y[EXIST[V.P.NAME] - 1]
M30
