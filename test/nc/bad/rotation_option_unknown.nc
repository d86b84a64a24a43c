; P-ERR-21615 rotation_option_unknown.nc line 2 column 15 '#ROTATION ON [ANGEL=30]': 'ANGEL=30' is not available in #ROTATION; its syntax is #ROTATION ON [ANGLE=30 CENTER1=10 CENTER2=5] or #ROTATION OFF
#ROTATION ON [ANGEL=30]
M30
