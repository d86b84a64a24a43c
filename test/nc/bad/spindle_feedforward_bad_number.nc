; P-ERR-21003 spindle_feedforward_bad_number.nc line 2 column 12 'N10 S[G135 G136=8.0.1]': 'G136=8.0.1' is not a letter with a number
N10 S[G135 G136=8.0.1]
M30
