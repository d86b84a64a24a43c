; P-ERR-21805 iso_call_without_number.nc line 3 column 1 'M98 L2': M98 without the program number P
; dialect iso
M98 L2
M30
