; P-ERR-21102 iso_skip_in_cycle.nc line 5 column 1 'G31 Z-5.': G31 while the drilling cycle G81 is on; G80 ends it
; dialect iso
G0 X0 Y0 Z10.
G81 X5. Z-3. R2. F100.
G31 Z-5.
M30
