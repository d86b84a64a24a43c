; P-ERR-21013 homing_with_feed.nc line 3 column 12 'N10 G74 S1 F100': F has no meaning with G74
; machine X Y / three
N10 G74 S1 F100
M30
