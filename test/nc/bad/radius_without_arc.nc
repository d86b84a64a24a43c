; P-ERR-21013 radius_without_arc.nc line 2 column 13 'N10 G00 X10 R5': R has no meaning with G00
N10 G00 X10 R5
M30
