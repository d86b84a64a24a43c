; P-ERR-21042 iso_unit_twice.nc line 3 column 5 'G21 G21': G21 twice in one block
; dialect iso
G21 G21
M30
