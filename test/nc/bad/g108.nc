; P-ERR-21050 g108.nc line 2 column 1 'G108': G108 is not available yet: edge banding
G108
M30
