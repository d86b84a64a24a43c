; P-ERR-21615 system_words_after.nc line 2 column 16 '#CS ON [1,2,3] X5': 'X5' is not available in #CS; its syntax is #CS DEF [1] [10, 0, 0, 0, 0, 90], #CS ON [10, 0, 0, 0, 0, 90], #CS ON [1], #CS OFF or #CS OFF ALL
#CS ON [1,2,3] X5
M30
