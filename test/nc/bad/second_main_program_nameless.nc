; P-ERR-21015 second_main_program_nameless.nc line 3 column 1 '%': main program is defined twice, first in line 2
N10 M30
%
N10 M30
