; P-ERR-21021 call_and_computed_end.nc line 5 column 10 'X[1] M30 LL UP': subroutine call and M30 in one block
%L UP
M29
%MAIN
X[1] M30 LL UP
M30
