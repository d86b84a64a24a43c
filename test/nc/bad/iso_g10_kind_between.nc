; P-ERR-21822 iso_g10_kind_between.nc line 3 column 5 'G10 L11 P1 X5': G10 L11: G10 sets zero offsets with L2 and L20 only
; dialect iso
G10 L11 P1 X5
M30
