; P-ERR-20612 preset_end_while_rotated.nc line 3 column 1 '#PRESET': #PRESET is not possible while the contour is mirrored, rotated or scaled
#ROTATION ON [ANGLE=30]
#PRESET
M30
