; P-ERR-20019 turn_mirrored.nc line 4 column 5 'G00 X30': axis X is mirrored (G21, G22, G23 or G351) while its words are diameters (G51)
; facing X
G17 G51 G21
G00 X30
M30
