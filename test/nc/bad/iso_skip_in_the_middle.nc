; P-ERR-21001 iso_skip_in_the_middle.nc line 3 column 4 'G0 /X1': unexpected character '/'
; dialect iso
G0 /X1
M30
