; P-ERR-21620 machine_coordinates_off.nc line 2 column 1 '#MCS OFF': #MCS OFF without #MCS ON
#MCS OFF
M30
