; P-ERR-21668 thread_offset_of_another_spindle.nc line 2 column 14 'G33 Z48 K1.5 S2.OFFSET=90': OFFSET of spindle S2; a thread is cut with the main spindle S
G33 Z48 K1.5 S2.OFFSET=90
M30
