; P-ERR-21666 thread_speed_changed.nc line 5 column 1 'Z60': S commands spindle S between two blocks of a thread; it must not change within a thread
M03 S400
G33 Z48 K1.5
S500
Z60
M30
