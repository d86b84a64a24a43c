; P-ERR-21050 iso_feed_per_revolution.nc line 3 column 1 'G95 F0.1': G95 is not available yet: feed per revolution
; dialect iso
G95 F0.1
M30
