; P-ERR-20042 turn_no_facing_axis_in_plane.nc line 3 column 5 'G19 G51': G51 without a facing axis in the plane G19 (P-AXIS-00015 0x40)
; facing X
G19 G51
M30
