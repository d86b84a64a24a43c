; P-ERR-21037 spindle_twice.nc line 2 column 15 'N10 M03 S1000 S[M05]': spindle S is programmed twice in one block
N10 M03 S1000 S[M05]
M30
