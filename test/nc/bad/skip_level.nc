; P-ERR-21011 skip_level.nc line 2 column 2 '/11 N10 G00 X10': block skip /11 must be /1 to /10
/11 N10 G00 X10
M30
