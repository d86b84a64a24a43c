; P-ERR-21021 call_and_end.nc line 5 column 9 'N10 M30 LL HOLE': subroutine call and M30 in one block
%L HOLE
M29
%MAIN
N10 M30 LL HOLE
