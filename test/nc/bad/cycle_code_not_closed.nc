; P-ERR-21401 cycle_code_not_closed.nc line 2 column 4 'G81[-10, 2': '[' is not closed in its line
G81[-10, 2
M30
