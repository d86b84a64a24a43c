; P-ERR-21615 rotation_option_twice.nc line 2 column 24 '#ROTATION ON [ANGLE=30 ANGLE=40]': 'ANGLE=40' is not available in #ROTATION; its syntax is #ROTATION ON [ANGLE=30 CENTER1=10 CENTER2=5] or #ROTATION OFF
#ROTATION ON [ANGLE=30 ANGLE=40]
M30
