; P-ERR-21013 measuring_centre.nc line 2 column 13 'N10 G100 X9 I3 F300': I has no meaning with G100
N10 G100 X9 I3 F300
M30
