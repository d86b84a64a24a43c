; P-ERR-21614 system_off_without_one.nc line 2 column 1 '#CS OFF': #CS OFF, but none is on
#CS OFF
M30
