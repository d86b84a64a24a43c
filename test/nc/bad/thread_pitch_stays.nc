; P-ERR-21663 thread_pitch_stays.nc line 5 column 1 'G33 X20': X moves most in this thread (X 20 mm), so its pitch is programmed with I, not with K
M03 S400
G33 Z48 K1.5
G00 Z50
G33 X20
M30
