; P-ERR-21599 argument_missing_in_a_call.nc line 6 column 1 'LL CYCLE [NAME=HOLE @P1=2]': HOLE does not give @P2, which argument_missing_in_a_call.nc reads in line 3
%L HOLE
G00 X[@P1] Y[@P2]
M29
%
LL CYCLE [NAME=HOLE @P1=2]
M30
