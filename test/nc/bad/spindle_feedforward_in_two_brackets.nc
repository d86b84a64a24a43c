; P-ERR-21037 spindle_feedforward_in_two_brackets.nc line 2 column 13 'N10 S[G135] S[G136=80]': spindle S is programmed twice in one block
N10 S[G135] S[G136=80]
M30
