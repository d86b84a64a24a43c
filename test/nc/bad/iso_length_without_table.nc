; P-ERR-21812 iso_length_without_table.nc line 5 column 5 'G43 H3 Z1.': G43 H3: no tool of the machine has a length; they are in a tool file (werkz_data) or in wz[3].laenge
; tools none
; dialect iso
T3 M6
G43 H3 Z1.
M30
