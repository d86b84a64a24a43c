; P-ERR-21669 thread_offset_large.nc line 2 column 14 'G33 Z48 K1.5 S.OFFSET=360': OFFSET 360 deg of spindle S must be from 0 to below 360
G33 Z48 K1.5 S.OFFSET=360
M30
