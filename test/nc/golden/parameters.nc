; P parameters, arrays, parameters of parameters.
#VAR
P20[3] = [10, 20, 30]
P21[2][2] = [1, 2, 3, 4]
#ENDVAR
P1 = 5 P2 = P1 * 2 P3 = 1
N10 G01 XP1 YP2 Z-P1 F[P2 * 100]
N20 X[P20[P3]] Y[P21[1][0]] Z=P21[0, 1]
P1 += 2 P2 -= 1 P3 *= 4 P20[0] /= 4
N30 X=P1 Y=P2 Z=P3
P4 = 8
N40 X=PP3 Y=P[P3 - 3] Z=P20[0]
P4 = 7
N50 X=PP3
N60 G[P3 - 4] X[P1] M[P3 * 2] S[P2 * 100]
M30
