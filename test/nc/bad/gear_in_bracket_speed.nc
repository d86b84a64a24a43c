; P-ERR-21074 gear_in_bracket_speed.nc line 3 column 5 'N10 S[M3 REV650]': speed 650 rpm in brackets: gears are changed in DIN syntax only (M40 to M45 and S)
; machine X / automatic
N10 S[M3 REV650]
M30
