; P-ERR-21015 iso_program_twice.nc line 7 column 1 'O2': subroutine O2 is defined twice, first in line 5
; dialect iso
O1
M30
O2
M99
O2
M99
