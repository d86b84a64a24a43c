; P-ERR-21003 bracket_bad_number.nc line 2 column 11 'N10 S[ M3 REV1.0.0]': 'REV1.0.0' is not a letter with a number
N10 S[ M3 REV1.0.0]
M30
