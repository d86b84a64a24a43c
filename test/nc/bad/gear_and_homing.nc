; P-ERR-20942 gear_and_homing.nc line 3 column 12 'N10 G74 S1 M41': M41 and G74 in one block
; machine X / gears
N10 G74 S1 M41
M30
