; P-ERR-21401 rotation_not_closed.nc line 2 column 14 '#ROTATION ON [ANGLE=30': '[' is not closed in its line
#ROTATION ON [ANGLE=30
M30
