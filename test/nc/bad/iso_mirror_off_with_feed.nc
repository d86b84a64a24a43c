; P-ERR-21013 iso_mirror_off_with_feed.nc line 3 column 10 'G50.1 X0 F5': F has no meaning with G50.1
; dialect iso
G50.1 X0 F5
M30
