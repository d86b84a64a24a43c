; P-ERR-21010 iso_number_negative.nc line 3 column 1 'N-5 G0 X1': N-5 must be an integer from 0 to 999999999
; dialect iso
N-5 G0 X1
M30
