; P-ERR-20797 iso_axis_unknown.nc line 3 column 4 'G0 A5': axis A is not in the machine; axes of this channel: X, Y, Z
; dialect iso
G0 A5
M30
