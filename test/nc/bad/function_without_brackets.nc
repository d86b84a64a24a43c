; P-ERR-21444 function_without_brackets.nc line 2 column 6 'P1 = NOT 1': NOT needs brackets, as in NOT[x]
P1 = NOT 1
M30
