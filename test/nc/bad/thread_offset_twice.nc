; P-ERR-21008 thread_offset_twice.nc line 2 column 26 'G33 Z48 K1.5 S.OFFSET=90 S.OFFSET=180': word S.OFFSET twice in one block: 90 and 180
G33 Z48 K1.5 S.OFFSET=90 S.OFFSET=180
M30
