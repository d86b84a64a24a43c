; P-ERR-21641 tap_without_position.nc line 3 column 1 'G63 Z-10 F250 S200': G63 needs a spindle with an actual position (P-AXIS-00320, P-SIM-00050) that the NC moves, S is none
; machine X Y Z / unpositioned
G63 Z-10 F250 S200
M30
