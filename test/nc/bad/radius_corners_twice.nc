; P-ERR-21012 radius_corners_twice.nc line 3 column 5 'G25 G26': G25 and G26 belong to one group (outer corners) and cannot be in one block
; tools milling
G25 G26
M30
