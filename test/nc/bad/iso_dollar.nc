; P-ERR-21001 iso_dollar.nc line 3 column 1 '$IF 1': unexpected character '$'
; dialect iso
$IF 1
M30
