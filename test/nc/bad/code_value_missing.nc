; P-ERR-21051 code_value_missing.nc line 2 column 1 'G159': G159 needs a value, as in G159=1
G159
M30
