; P-ERR-21015 iso_number_twice_before.nc line 6 column 1 'O2000': subroutine O2000 is defined twice, first in line 3
; dialect iso
O2000
G0 X1
M99
O2000
G0 X2
M99
O1
M98 P2000
M30
