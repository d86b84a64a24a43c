; P-ERR-21005 number_without_word.nc line 2 column 13 'N10 G00 X10 -5': number '-5' without a letter; only G04 takes a bare number
N10 G00 X10 -5
M30
