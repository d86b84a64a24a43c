; P-ERR-21812 iso_length_without_table.nc line 5 column 5 'G43 H3 Z1.': G43 H3: there is no tool table with lengths (werkz_data of the channel)
; tools none
; dialect iso
T3 M6
G43 H3 Z1.
M30
