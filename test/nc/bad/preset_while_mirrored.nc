; P-ERR-20612 preset_while_mirrored.nc line 3 column 1 '#PSET X5': #PSET is not possible while the contour is mirrored, rotated or scaled
G21
#PSET X5
M30
