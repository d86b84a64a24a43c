; P-ERR-21670 thread_change_missing.nc line 3 column 1 'G34 Z48 K1.5': G34 has no change of its lead; it is programmed with F above 0 in mm per revolution each
M03 S400
G34 Z48 K1.5
M30
