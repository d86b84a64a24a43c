; P-ERR-21004 iso_number_too_long.nc line 3 column 4 'G0 X1234567890': number 'X1234567890' has more than 9 digits before the decimal point
; dialect iso
G0 X1234567890
M30
