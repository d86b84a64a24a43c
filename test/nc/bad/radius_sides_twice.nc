; P-ERR-21012 radius_sides_twice.nc line 3 column 5 'G41 G42 X1': G41 and G42 belong to one group (tool radius) and cannot be in one block
; tools milling
G41 G42 X1
M30
