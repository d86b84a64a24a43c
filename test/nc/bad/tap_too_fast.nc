; P-ERR-22010 tap_too_fast.nc line 3 column 16 'G63 Z-10 F6000 S4800': spindle S: 4800 rpm is above the maximum 4000 rpm (P-AXIS-00212)
; machine X Y Z / limited
G63 Z-10 F6000 S4800
M30
