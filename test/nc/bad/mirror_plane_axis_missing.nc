; P-ERR-21603 mirror_plane_axis_missing.nc line 3 column 5 'G17 G21': G21 needs the axes X and Y of plane G17; axes of this channel: X, Z
; machine X Z / S
G17 G21
M30
