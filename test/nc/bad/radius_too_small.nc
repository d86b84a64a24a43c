; P-ERR-21034 radius_too_small.nc line 2 column 16 'N10 G03 X20 Y0 R-9.9 F600': radius R -9.9 mm is too small: start and target are 20 mm apart, at most 19.8 mm can be reached
N10 G03 X20 Y0 R-9.9 F600
M30
