; P-ERR-21014 iso_no_program.nc line 4 column 1 '%': no main program
; dialect iso
%
%
