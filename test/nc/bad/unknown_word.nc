; P-ERR-21002 unknown_word.nc line 2 column 13 'N10 G01 X10 E5 F600': unknown word 'E5'
N10 G01 X10 E5 F600
M30
