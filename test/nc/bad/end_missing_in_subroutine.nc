; P-ERR-21017 end_missing_in_subroutine.nc line 3 column 1 'N10 G00 Z5': subroutine HOLE has no M29 or M17 at its end
%L HOLE
N10 G00 Z5
%MAIN
N10 LL HOLE
N20 M30
