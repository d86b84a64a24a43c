; P-ERR-21001 iso_not_ascii.nc line 3 column 5 'G0 Xé': unexpected character 'é'
; dialect iso
G0 Xé
M30
