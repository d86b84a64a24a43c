; P-ERR-21054 macro_call.nc line 2 column 5 'N10 "RELPOS" M8': "RELPOS" is no word: texts are values of expressions, macros are not available
N10 "RELPOS" M8
M30
