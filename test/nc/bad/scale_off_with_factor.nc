; P-ERR-21615 scale_off_with_factor.nc line 2 column 12 '#SCALE OFF X2': 'X2' is not available in #SCALE; its syntax is #SCALE X2 Y2, #SCALE ON, #SCALE ON X2 Y2 or #SCALE OFF
#SCALE OFF X2
M30
