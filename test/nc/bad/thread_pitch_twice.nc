; P-ERR-21662 thread_pitch_twice.nc line 3 column 18 'G33 Z48 X10 I1.5 K1.5': pitch by I and by K; G33 takes one of them
M03 S400
G33 Z48 X10 I1.5 K1.5
M30
