; P-ERR-21615 scale_word.nc line 2 column 11 '#SCALE ON FACTOR2': 'FACTOR2' is not available in #SCALE; its syntax is #SCALE X2 Y2, #SCALE ON, #SCALE ON X2 Y2 or #SCALE OFF
#SCALE ON FACTOR2
M30
