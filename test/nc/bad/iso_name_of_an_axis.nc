; P-ERR-21001 iso_name_of_an_axis.nc line 3 column 6 'G0 X1=5': unexpected character '='
; dialect iso
G0 X1=5
M30
