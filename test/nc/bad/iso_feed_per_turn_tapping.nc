; P-ERR-20635 iso_feed_per_turn_tapping.nc line 5 column 1 'G84 X0. Y0. Z-5. R2. F1.': G84 with a feed per turn (G95); G94 ends it
; machine X Y Z / S
; dialect iso
G95 F0.1 S500
G84 X0. Y0. Z-5. R2. F1.
M30
