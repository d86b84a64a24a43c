; P-ERR-21812 iso_tool_length.nc line 3 column 5 'G43 H1 Z5': G43 H1: there is no tool table with lengths (werkz_data of the channel)
; dialect iso
G43 H1 Z5
M30
