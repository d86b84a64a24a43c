; P-ERR-21008 iso_tool_twice.nc line 3 column 4 'T1 T2': word T twice in one block: 1 and 2
; dialect iso
T1 T2
M30
