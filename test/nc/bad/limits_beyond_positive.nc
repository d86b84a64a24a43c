; P-ERR-120002 limits_beyond_positive.nc line 3 column 5 'G00 X5': axis X: 5 mm lies beyond the software limit 4 mm of G99
G99 X4
G00 X5
M30
