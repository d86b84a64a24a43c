; P-ERR-21043 comment_bracket_open.nc line 3 column 7 'G0 X1 (to (nested) Y2': '(' without ')' in its line; what is behind it would not be executed. A comment up to the end begins with ;
; the whole line is refused
G0 X1 (to (nested) Y2
M30
