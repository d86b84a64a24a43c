; P-ERR-21050 iso_boring_by_hand.nc line 3 column 1 'G88 X1': G88 is not available yet: boring with a stop and a retraction by hand
; dialect iso
G88 X1
M30
