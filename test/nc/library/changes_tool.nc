; a cycle that changes the tool
N10 T2 D2
N20 Z0
M29
