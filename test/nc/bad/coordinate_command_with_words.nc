; P-ERR-21075 coordinate_command_with_words.nc line 2 column 1 'X5 #ROTATION OFF': #ROTATION must be alone in its block, not with 'X5'
X5 #ROTATION OFF
M30
