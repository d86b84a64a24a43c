; P-ERR-21070 gear_not_programmed_below.nc line 4 column 5 'N20 M41 S350': speed 350 rpm of spindle S is not in gear stage M41, 400 to 800 rpm
; machine X / gears
N10 M41 S500 M03
N20 M41 S350
M30
