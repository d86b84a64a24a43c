; P-ERR-21615 preset_word.nc line 2 column 7 '#PSET [X5]': '[X5]' is not available in #PSET; its syntax is #PSET X10 Y20
#PSET [X5]
M30
