; P-ERR-20180 thread_offset_unknown_spindle.nc line 2 column 14 'G33 Z48 K1.5 S7.OFFSET=90': spindle S7 does not belong to this channel; its spindles are: S, S2
G33 Z48 K1.5 S7.OFFSET=90
M30
