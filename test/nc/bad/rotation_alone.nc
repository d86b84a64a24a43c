; P-ERR-21616 rotation_alone.nc line 2 column 10 '#ROTATION': #ROTATION without ON or OFF; its syntax is #ROTATION ON [ANGLE=30 CENTER1=10 CENTER2=5] or #ROTATION OFF
#ROTATION
M30
