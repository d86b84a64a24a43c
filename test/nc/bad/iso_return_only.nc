; P-ERR-21014 iso_return_only.nc line 5 column 1 'M99': no main program
; dialect iso
O1
G0 X1
M99
