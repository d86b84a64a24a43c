; P-ERR-20296 iso_tool_length_unknown.nc line 4 column 5 'G43 H5 Z5': H5: the tool table has no compensation data D5; known are: D1, D2, D3, D7, D13
; dialect iso
; tools milling
G43 H5 Z5
M30
