; P-ERR-21421 overflow_exponential.nc line 2 column 4 'P1=EXP[1000]': the result of EXP is beyond the range of numbers
P1=EXP[1000]
M30
