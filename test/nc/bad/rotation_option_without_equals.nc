; P-ERR-21615 rotation_option_without_equals.nc line 2 column 21 '#ROTATION ON [ANGLE 30]': '30' is not available in #ROTATION; its syntax is #ROTATION ON [ANGLE=30 CENTER1=10 CENTER2=5] or #ROTATION OFF
#ROTATION ON [ANGLE 30]
M30
