; P-ERR-21012 iso_end_and_call.nc line 3 column 8 'M98 P1 M30': M98 and M30 belong to one group (program flow) and cannot be in one block
; dialect iso
M98 P1 M30
O1
M99
