; P-ERR-21822 iso_g10_kind.nc line 3 column 5 'G10 L1 P1 X5': G10 L1: G10 sets zero offsets with L2 and L20 only
; dialect iso
G10 L1 P1 X5
M30
