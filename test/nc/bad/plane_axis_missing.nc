; P-ERR-21031 plane_axis_missing.nc line 3 column 5 'N10 G02 X10 I5 F600': plane G17 needs the axes X and Y; axes of this channel: X, Z
; machine X Z / S
N10 G02 X10 I5 F600
M30
