; P-ERR-21575 goto_out_of_subroutine.nc line 3 column 8 '$GOTO N5': subroutine UP has no label N5
%L UP
$GOTO N5
M29
%MAIN
N5: X1
LL UP
M30
