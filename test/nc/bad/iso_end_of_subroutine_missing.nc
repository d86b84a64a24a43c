; P-ERR-21017 iso_end_of_subroutine_missing.nc line 6 column 1 'X1': subroutine O5 has no M99 at its end
; dialect iso
M98 P5
M30
O5
X1
