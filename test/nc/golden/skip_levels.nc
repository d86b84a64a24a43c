; Skip levels before words, statements and calls: nothing is skipped without a switch.
%L UP
/ Y1
/2 Y2
M29
%SKIP
/ G00 X1
/1 X2
/10 X3
/3 LL UP
/ $IF 1
X4
/ $ENDIF
/2 P1 = 5
X[P1]
M30
