; P-ERR-21008 bracket_speed_twice.nc line 2 column 14 'N10 S[REV100 REV200]': word REV twice in one block: 100 and 200
N10 S[REV100 REV200]
M30
