; P-ERR-21050 later_per_revolution.nc line 2 column 1 'G95 F0.1': G95 is not available yet: feed per revolution
G95 F0.1
M30
