; P-ERR-21013 centre_word_without_arc.nc line 2 column 13 'N10 G01 X10 I5 F600': I has no meaning with G01
N10 G01 X10 I5 F600
M30
