; P-ERR-21802 iso_comment_open.nc line 3 column 7 'G0 X1 (to the end': '(' without ')' in its line
; dialect iso
G0 X1 (to the end
M30
