; P-ERR-21038 bracket_word.nc line 2 column 17 'N10 S[M3 REV100 OFFSET5]': 'OFFSET5' is not available in the brackets of spindle S; known are: M3, M4, M5, M19, REV, POS, G74, G167, G135, G136, G137, DEFAULT_DYNAMIC_DATA, free M functions
N10 S[M3 REV100 OFFSET5]
M30
