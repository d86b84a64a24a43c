; P-ERR-21542 words_after_call.nc line 5 column 13 'N10 LL HOLE X10': 'X10' after a subroutine call
%L HOLE
M29
%MAIN
N10 LL HOLE X10
M30
