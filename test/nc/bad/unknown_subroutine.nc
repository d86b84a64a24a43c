; P-ERR-21019 unknown_subroutine.nc line 5 column 5 'N20 LL HOLES': unknown subroutine HOLES; known are: HOLE
%L HOLE
N10 M29
%MAIN
N20 LL HOLES
N30 M30
