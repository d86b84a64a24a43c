; P-ERR-21050 iso_dynamic_length.nc line 3 column 1 'G43.1 K5': G43.1 is not available yet: tool lengths without a table
; dialect iso
G43.1 K5
M30
