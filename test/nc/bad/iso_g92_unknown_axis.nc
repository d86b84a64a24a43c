; P-ERR-20797 iso_g92_unknown_axis.nc line 3 column 5 'G92 A5': axis A is not in the machine; axes of this channel: X, Y, Z
; dialect iso
G92 A5
M30
