; P-ERR-21020 iso_call_itself.nc line 6 column 5 'M98 P1': call of subroutine O1 at depth 21, the limit is 20
; dialect iso
M98 P1
M30
O1
M98 P1
M99
