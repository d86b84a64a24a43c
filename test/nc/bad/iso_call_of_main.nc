; P-ERR-21019 iso_call_of_main.nc line 4 column 5 'M98 P1': unknown subroutine O1; known are: none
; dialect iso
O1
M98 P1
M30
