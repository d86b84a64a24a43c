; P-ERR-20064 turn_two_facing_axes.nc line 3 column 5 'G18 G51': G51 with two facing axes in the plane G18, X and Z (P-AXIS-00015 0x40)
; facing X and Z
G18 G51
M30
