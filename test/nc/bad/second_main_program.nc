; P-ERR-21015 second_main_program.nc line 4 column 1 '%SECOND': main program SECOND is defined twice, first in line 2
%FIRST
N10 M30
%SECOND
N10 M30
