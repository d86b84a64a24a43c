; P-ERR-21501 for_not_closed_in_subroutine.nc line 3 column 1 '$FOR P1=1,2,1': $FOR of line 3 has no $ENDFOR before the end of subroutine UP
%L UP
$FOR P1=1,2,1
M29
%MAIN
LL UP
M30
