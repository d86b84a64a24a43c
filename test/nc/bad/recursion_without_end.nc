; P-ERR-21020 recursion_without_end.nc line 3 column 1 'LL UP': call of subroutine UP at depth 21, the limit is 20
%L UP
LL UP
M29
%MAIN
LL UP
M30
