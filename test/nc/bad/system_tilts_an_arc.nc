; P-ERR-21609 system_tilts_an_arc.nc line 3 column 1 'G02 X10 I5 F100': arcs in a coordinate system that is turned out of the plane G17 are not available yet
#CS ON [0,0,0,0,30]
G02 X10 I5 F100
M30
