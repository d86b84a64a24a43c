; P-ERR-20797 iso_g28_unknown_axis_among_others.nc line 3 column 12 'G91 G28 X0 W0': axis W is not in the machine; axes of this channel: X, Y, Z
; dialect iso
G91 G28 X0 W0
M30
