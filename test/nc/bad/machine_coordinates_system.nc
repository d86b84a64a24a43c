; P-ERR-21618 machine_coordinates_system.nc line 3 column 1 '#CS ON [1, 2, 3]': #CS is not possible between #MCS ON and #MCS OFF
#MCS ON
#CS ON [1, 2, 3]
M30
