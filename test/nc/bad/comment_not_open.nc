; P-ERR-21007 comment_not_open.nc line 2 column 15 'N10 G00 X10 up) Y5': ')' closes a comment that was never opened
N10 G00 X10 up) Y5
M30
