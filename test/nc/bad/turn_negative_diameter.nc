; P-ERR-21721 turn_negative_diameter.nc line 4 column 5 'G00 X-1.6': diameter X-1.6 is negative
; facing X
G18 G51
G00 X-1.6
M30
