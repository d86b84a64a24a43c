; P-ERR-21013 weights_with_centre.nc line 2 column 14 'N10 G136 X80 I5': I has no meaning with G136
N10 G136 X80 I5
M30
