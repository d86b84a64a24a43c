; P-ERR-21619 machine_coordinates_twice.nc line 3 column 1 '#MCS ON': #MCS ON, but it is on already
#MCS ON
#MCS ON
M30
