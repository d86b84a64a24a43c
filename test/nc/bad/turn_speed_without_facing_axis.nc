; P-ERR-20634 turn_speed_without_facing_axis.nc line 3 column 1 'G96 S120': G96 without a facing axis in the plane G18 (P-AXIS-00015 0x40)
G18 M03 S100
G96 S120
M30
