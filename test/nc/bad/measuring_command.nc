; P-ERR-21006 measuring_command.nc line 2 column 1 '#MEAS MODE [EDGE]': command '#MEAS' is not available
#MEAS MODE [EDGE]
M30
