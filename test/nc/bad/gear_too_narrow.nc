; P-ERR-21070 gear_too_narrow.nc line 3 column 5 'N10 M40 S750': speed 750 rpm of spindle S is not in gear stage M40, 50 to 560 rpm
; machine X / automatic
N10 M40 S750
M30
