; P-ERR-21071 gear_not_programmed_two_fit.nc line 4 column 5 'N20 S450': speed 450 rpm of spindle S is not in the active gear stage M42, 700 to 3500 rpm; it needs M40 or M41 in the block
; machine X / gears
N10 M42 S900 M03
N20 S450
M30
