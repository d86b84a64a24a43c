; P-ERR-21042 comp_word_twice.nc line 2 column 21 'N10 X[COMP ON FRICT FRICT]': FRICT twice in one block
N10 X[COMP ON FRICT FRICT]
M30
