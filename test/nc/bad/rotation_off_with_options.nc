; P-ERR-21615 rotation_off_with_options.nc line 2 column 15 '#ROTATION OFF [ANGLE=30]': '[ANGLE=30]' is not available in #ROTATION; its syntax is #ROTATION ON [ANGLE=30 CENTER1=10 CENTER2=5] or #ROTATION OFF
#ROTATION OFF [ANGLE=30]
M30
