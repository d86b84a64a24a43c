; P-ERR-20042 turn_no_facing_axis.nc line 2 column 5 'G18 G51': G51 without a facing axis in the plane G18 (P-AXIS-00015 0x40)
G18 G51
M30
