; P-ERR-21666 thread_direction_changed.nc line 4 column 5 'Z60 M04': M04 commands spindle S between two blocks of a thread; it must not change within a thread
M03 S400
G33 Z48 K1.5
Z60 M04
M30
