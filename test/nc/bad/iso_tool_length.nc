; P-ERR-21812 iso_tool_length.nc line 3 column 5 'G43 H1 Z5': G43 H1: no tool of the machine has a length; they are in a tool file (werkz_data) or in wz[1].laenge
; dialect iso
G43 H1 Z5
M30
