; P-ERR-21038 bracket_speed_twice.nc line 2 column 14 'N10 S[REV100 REV200]': 'REV200' is not available in the brackets of spindle S; known are: M3, M4, M5, M19, REV, POS, G74, G167, G135, G136, G137, DEFAULT_DYNAMIC_DATA, free M functions
N10 S[REV100 REV200]
M30
