; P-ERR-21012 iso_spindle_twice.nc line 3 column 4 'M3 M4 S100': M03 and M04 belong to one group (spindle) and cannot be in one block
; dialect iso
M3 M4 S100
M30
