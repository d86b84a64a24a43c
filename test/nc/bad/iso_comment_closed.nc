; P-ERR-21007 iso_comment_closed.nc line 3 column 6 'G0 X1)': ')' closes a comment that was never opened
; dialect iso
G0 X1)
M30
