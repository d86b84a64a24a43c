; P-ERR-21600 offset_index_with_decimals.nc line 2 column 1 'G159=1.5': zero offset 1.5 does not exist: G159=0 to G159=96
G159=1.5
M30
