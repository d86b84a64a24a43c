; P-ERR-21050 later_thread.nc line 2 column 1 'G33 Z10 K1': G33 is not available yet: thread cutting
G33 Z10 K1
M30
