; Limits of the program, absolute and relative.
G98 X-10 Y-10
G99 X50 Y60
G00 X50 Y60
G91
G99 X10
G90 X60
X-10 Y-10
X[V.A.+SWE.X / 10] Y[V.A.-SWE.Y]
M30
