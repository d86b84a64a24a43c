; P-ERR-21075 deleted_with_words.nc line 3 column 15 '#DELETE V.P.A X5': #DELETE must be alone in its block, not with 'X5'
V.P.A=1
#DELETE V.P.A X5
M30
