; P-ERR-21050 later_contour.nc line 2 column 1 'G61 X5': G61 is not available yet: contouring of corners
G61 X5
M30
