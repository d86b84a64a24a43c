; P-ERR-21037 spindle_twice_bracket.nc line 2 column 13 'N10 S2[M05] S2[REV1000]': spindle S2 is programmed twice in one block
N10 S2[M05] S2[REV1000]
M30
