; P-ERR-21610 system_number_large.nc line 2 column 10 '#CS DEF [6] [1,2,3]': coordinate system 6 must be an integer from 1 to 5
#CS DEF [6] [1,2,3]
M30
