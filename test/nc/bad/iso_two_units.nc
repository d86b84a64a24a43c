; P-ERR-21012 iso_two_units.nc line 3 column 5 'G20 G21': G20 and G21 belong to one group (units) and cannot be in one block
; dialect iso
G20 G21
M30
