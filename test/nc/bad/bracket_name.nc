; P-ERR-21038 bracket_name.nc line 2 column 10 'N10 S[M3 CALLAX]': 'CALLAX' is not available in the brackets of spindle S; known are: M3, M4, M5, M19, REV, POS, G74, G167, G135, G136, G137, DEFAULT_DYNAMIC_DATA, free M functions
N10 S[M3 CALLAX]
M30
