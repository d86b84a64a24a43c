; P-ERR-21075 flush_with_words.nc line 2 column 13 '#FLUSH WAIT X5': #FLUSH WAIT must be alone in its block, not with 'X5'
#FLUSH WAIT X5
M30
