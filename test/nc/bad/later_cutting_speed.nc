; P-ERR-21050 later_cutting_speed.nc line 2 column 1 'G96 S200': G96 is not available yet: constant cutting speed
G96 S200
M30
