; P-ERR-21013 iso_tool_length_alone.nc line 3 column 7 'G0 X1 H1': H has no meaning with G00
; dialect iso
G0 X1 H1
M30
