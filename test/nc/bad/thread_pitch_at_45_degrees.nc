; P-ERR-21663 thread_pitch_at_45_degrees.nc line 3 column 13 'G33 Z48 X48 K5': X moves most in this thread (X 48 mm, Z 48 mm), so its pitch is programmed with I, not with K
M03 S400
G33 Z48 X48 K5
M30
