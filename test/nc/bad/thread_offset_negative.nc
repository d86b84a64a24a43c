; P-ERR-21669 thread_offset_negative.nc line 2 column 14 'G33 Z48 K1.5 S.OFFSET=-90': OFFSET -90 deg of spindle S must be from 0 to below 360
G33 Z48 K1.5 S.OFFSET=-90
M30
