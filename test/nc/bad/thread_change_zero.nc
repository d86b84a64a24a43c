; P-ERR-21670 thread_change_zero.nc line 3 column 14 'G35 Z48 K1.5 F0': G35 has no change of its lead; it is programmed with F above 0 in mm per revolution each
M03 S400
G35 Z48 K1.5 F0
M30
