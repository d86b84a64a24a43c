; P-ERR-21581 comment_not_closed.nc line 2 column 1 '#COMMENT BEGIN': #COMMENT BEGIN of line 2 has no #COMMENT END
#COMMENT BEGIN
X5
M30
