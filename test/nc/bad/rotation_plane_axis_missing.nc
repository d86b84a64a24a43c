; P-ERR-21603 rotation_plane_axis_missing.nc line 3 column 1 '#ROTATION ON [ANGLE=30]': #ROTATION needs the axes X and Y of plane G17; axes of this channel: X, Z
; machine X Z / S
#ROTATION ON [ANGLE=30]
M30
