; P-ERR-21050 iso_thread.nc line 3 column 1 'G33 Z-5 K1': G33 is not available yet: thread cutting
; dialect iso
G33 Z-5 K1
M30
