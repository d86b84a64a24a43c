; P-ERR-21018 iso_return_in_main.nc line 4 column 1 'M99': M99 ends a subroutine, but this is the main program
; dialect iso
G0 X1
M99
