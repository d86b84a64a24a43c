; P-ERR-21017 iso_behind_percent_is_nothing.nc line 5 column 1 '%': main program has no M30 or M02 at its end
; dialect iso
%
G0 X1
%
M30
