; P-ERR-21038 bracket_word.nc line 2 column 7 'N10 S[M19 POS90]': 'M19' is not available in the brackets of spindle S; known are: M3, M4, M5, REV, G135, G136, G137
N10 S[M19 POS90]
M30
