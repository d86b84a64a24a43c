; P-ERR-21039 expression_empty_bracket.nc line 2 column 1 'X[]': the brackets of X are empty
X[]
M30
