; P-ERR-21660 thread_pitch_missing.nc line 3 column 1 'G33 Z48': G33 has no pitch; it is programmed with K in mm per revolution
M03 S400
G33 Z48
M30
