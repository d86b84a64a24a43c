; P-ERR-21071 gear_not_programmed.nc line 4 column 5 'N20 S950': speed 950 rpm of spindle S is not in the active gear stage M41, 400 to 800 rpm; it needs M42 in the block
; machine X / gears
N10 M41 S650 M03
N20 S950
M30
