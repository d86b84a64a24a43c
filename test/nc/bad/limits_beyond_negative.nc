; P-ERR-120003 limits_beyond_negative.nc line 4 column 5 'G03 Y1 J-2 F100': axis Y: -3 mm lies beyond the software limit -1 mm of G98
G98 Y-1
G00 Y1
G03 Y1 J-2 F100
M30
