; A call after each motion, and after each block; the end of the level ends it.
%L DOT
G91 Z-1
Z1
M29
%L ROW
LL CYCLE [NAME=DOT MODAL_MOVE]
G00 X1
M08
X2
M29
%MAIN
LL ROW
X3
LL CYCLE [NAME=DOT MODAL_BLOCK]
M09
#DISABLE MODAL CYCLE
X4
M30
