; P-ERR-21020 recursion.nc line 4 column 5 'N20 LL HOLE': call of subroutine HOLE at depth 21, the limit is 20
%L HOLE
N10 G91 G00 Z1
N20 LL HOLE
N30 M29
%MAIN
N40 LL HOLE
N50 M30
