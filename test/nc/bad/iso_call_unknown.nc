; P-ERR-21019 iso_call_unknown.nc line 3 column 5 'M98 P77': unknown subroutine O77; known are: none
; dialect iso
M98 P77
M30
