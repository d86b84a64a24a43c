; P-ERR-21050 iso_radius_compensation.nc line 3 column 1 'G41 D1 X5': G41 is not available yet: compensation of the tool radius
; dialect iso
G41 D1 X5
M30
