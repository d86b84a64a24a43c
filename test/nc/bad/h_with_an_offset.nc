; P-ERR-21013 h_with_an_offset.nc line 2 column 8 'G92 X1 H5': H has no meaning with G92
G92 X1 H5
M30
