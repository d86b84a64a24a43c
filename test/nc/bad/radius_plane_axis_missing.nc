; P-ERR-21031 radius_plane_axis_missing.nc line 5 column 1 'G41 G01 X20 Z5': plane G17 needs the axes X and Y; axes of this channel: X, Z
; machine X Z / S
; tools turning
D6 G00 X10 F100
G41 G01 X20 Z5
Z10
M30
