; P-ERR-21001 iso_quotation.nc line 3 column 4 'G0 "X"': unexpected character '"'
; dialect iso
G0 "X"
M30
