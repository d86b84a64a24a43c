; P-ERR-20634 iso_cutting_speed_axis.nc line 4 column 5 'G18 G96 S100': G96 without a facing axis in the plane G18 (P-AXIS-00015 0x40)
; machine X Z / S
; dialect iso
G18 G96 S100
M30
