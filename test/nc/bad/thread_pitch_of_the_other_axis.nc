; P-ERR-21663 thread_pitch_of_the_other_axis.nc line 3 column 9 'G33 Z48 I1.5': Z moves most in this thread (Z 48 mm), so its pitch is programmed with K, not with I
M03 S400
G33 Z48 I1.5
M30
