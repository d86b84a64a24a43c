; P-ERR-21806 iso_call_count_zero.nc line 3 column 8 'M98 P1 L0': L0 must be an integer from 1 to 9999
; dialect iso
M98 P1 L0
M30
O1
M99
