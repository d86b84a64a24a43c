; P-ERR-21043 comment_bracket_open_in_name.nc line 2 column 7 '%PART (first': '(' without ')' in its line; what is behind it would not be executed. A comment up to the end begins with ;
%PART (first
X1
M30
