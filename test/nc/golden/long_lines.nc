; Continued lines in words, arrays and calls.
#VAR
V.P.A[4] = [1, \
 2, \
 3, \
 4]
#ENDVAR
G01 \
 X[V.P.A[0] + \
   V.P.A[1]] \
 Y=V.P.A[2] \
 F[100 * V.P.A[3]]
L CYCLE [NAME=drill.nc \
 @P1=-4 \
 @P2=3]
M30
