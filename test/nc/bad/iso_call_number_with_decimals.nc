; P-ERR-21806 iso_call_number_with_decimals.nc line 3 column 5 'M98 P1.5': P1.5 must be an integer from 0 to 99999999
; dialect iso
M98 P1.5
M30
