; Codes, tools and functions whose numbers are computed.
P1 = 1
G[P1] X10 F600
G[P1 - 1] X20
G[90 + P1] X5
G[91 - P1] X0
M[P1 * 8] T[P1 * 3] D[P1]
M30
