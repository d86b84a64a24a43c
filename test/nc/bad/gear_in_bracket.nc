; P-ERR-21074 gear_in_bracket.nc line 3 column 5 'N10 S[M41 REV650]': M41 in brackets: gears are changed in DIN syntax only (M40 to M45 and S)
; machine X / gears
N10 S[M41 REV650]
M30
