; P-ERR-21582 comment_end_stray.nc line 2 column 1 '#COMMENT END': #COMMENT END without #COMMENT BEGIN before it
#COMMENT END
M30
