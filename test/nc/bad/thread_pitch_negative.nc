; P-ERR-21661 thread_pitch_negative.nc line 3 column 9 'G33 Z48 K-1.5': pitch K-1.5 must be above 0 (mm per revolution, without a sign)
M03 S400
G33 Z48 K-1.5
M30
