; P-ERR-21070 gear_too_narrow_while_turning.nc line 4 column 5 'N20 M40': speed 650 rpm of spindle S is not in gear stage M40, 50 to 560 rpm
; machine X / gears
N10 M41 S650 M03
N20 M40
M30
