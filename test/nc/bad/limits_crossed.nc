; P-ERR-21649 limits_crossed.nc line 3 column 5 'G99 X4': software limits of axis X: negative 5 mm is not below positive 4 mm
G98 X5
G99 X4
M30
