; P-ERR-21807 iso_tool_length_without_number.nc line 3 column 1 'G43 Z5': G43 without H: the number of the tool length
; dialect iso
G43 Z5
M30
