; P-ERR-21600 offset_index_negative.nc line 2 column 1 'G159=-1': zero offset -1 does not exist: G159=0 to G159=96
G159=-1
M30
