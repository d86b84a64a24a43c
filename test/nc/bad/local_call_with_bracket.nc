; P-ERR-21597 local_call_with_bracket.nc line 6 column 16 'G00 X1 LL HOLE [@P1=1]': parameters need a cycle call: LL CYCLE [NAME=HOLE @P1=...]
%L HOLE
G00 Z[@P1]
M29
%MAIN
G00 X1 LL HOLE [@P1=1]
M30
