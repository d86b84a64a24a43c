; P-ERR-21615 system_off_words.nc line 2 column 13 '#CS OFF ALL X5': 'X5' is not available in #CS; its syntax is #CS DEF [1] [10, 0, 0, 0, 0, 90], #CS ON [10, 0, 0, 0, 0, 90], #CS ON [1], #CS OFF or #CS OFF ALL
#CS OFF ALL X5
M30
