; P-ERR-21599 cycle_code_argument_missing.nc line 3 column 1 'G81[-10]': G81 does not give @P2, which g81.nc reads in line 17
F100
G81[-10]
M30
