; P-ERR-21616 machine_coordinates_nothing.nc line 2 column 5 '#MCS': #MCS without ON or OFF; its syntax is #MCS ON or #MCS OFF
#MCS
M30
