; P-ERR-21600 offset_index_large.nc line 2 column 1 'G159=97': zero offset 97 does not exist: G159=0 to G159=96
G159=97
M30
