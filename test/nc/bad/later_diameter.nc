; P-ERR-21050 later_diameter.nc line 2 column 1 'G51': G51 is not available yet: diameter programming of the face turning axis
G51
M30
