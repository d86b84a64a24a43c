; P-ERR-21013 reference_offset_with_feed.nc line 2 column 8 'G92 X5 F100': F has no meaning with G92
G92 X5 F100
M30
