; P-ERR-21807 iso_g10_without_kind.nc line 3 column 1 'G10 P1 X5': G10 without L: L2 or L20
; dialect iso
G10 P1 X5
M30
