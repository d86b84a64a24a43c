; P-ERR-21596 argument_unread_by_a_cycle_code.nc line 2 column 12 'G81[-4, 2, 0.5]': G81 does not read parameter @P3; parameters that it reads: @P1, @P2
G81[-4, 2, 0.5]
M30
