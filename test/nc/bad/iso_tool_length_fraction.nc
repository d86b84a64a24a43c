; P-ERR-21806 iso_tool_length_fraction.nc line 3 column 5 'G43 H1.5': H1.5 must be an integer from 0 to 999999999
; dialect iso
G43 H1.5
M30
