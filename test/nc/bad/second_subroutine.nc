; P-ERR-21015 second_subroutine.nc line 4 column 1 '%L hole': subroutine hole is defined twice, first in line 2
%L HOLE
M29
%L hole
M29
%MAIN
M30
