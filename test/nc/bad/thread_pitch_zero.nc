; P-ERR-21661 thread_pitch_zero.nc line 3 column 9 'G33 Z48 K0': pitch K0 must be above 0 (mm per revolution, without a sign)
M03 S400
G33 Z48 K0
M30
