; P-ERR-20797 iso_g28_unknown_axis.nc line 3 column 5 'G28 U0 W0': axis U is not in the machine; axes of this channel: X, Y, Z
; dialect iso
G28 U0 W0
M30
