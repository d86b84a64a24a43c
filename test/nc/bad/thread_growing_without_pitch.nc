; P-ERR-21660 thread_growing_without_pitch.nc line 3 column 1 'G34 X48 F0.1': G34 has no pitch; it is programmed with I in mm per revolution
M03 S400
G34 X48 F0.1
M30
