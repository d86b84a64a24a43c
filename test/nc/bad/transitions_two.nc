; P-ERR-21012 transitions_two.nc line 2 column 5 'G60 G261 X5': G60 and G261 belong to one group (block transition) and cannot be in one block
G60 G261 X5
