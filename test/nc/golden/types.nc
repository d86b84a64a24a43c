; Types of variables: integers are rounded, texts have a length.
#VAR
V.P.A : UNS08 = 3.4
V.P.B : SGN16 = -3.6
V.P.C : BOOLEAN = 1
V.P.D : REAL64 = 3.4
V.P.E : STRING[5] = "12345"
V.P.F[3] : UNS32 = [1.2, 1.5, 1.8]
#ENDVAR
G00 X=V.P.A Y=V.P.B Z=V.P.C
V.P.A = V.P.A / 2
V.P.C = 0.2
X=V.P.A Y=V.P.D Z=V.P.C
X=V.P.F[0] Y=V.P.F[1] Z=V.P.F[2]
V.P.E = LEFT[V.P.E, 3]
X[LEN[V.P.E]]
M30
