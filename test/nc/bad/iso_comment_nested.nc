; P-ERR-21007 iso_comment_nested.nc line 3 column 15 'G0 X1 (a (b) c)': ')' closes a comment that was never opened
; dialect iso
G0 X1 (a (b) c)
M30
