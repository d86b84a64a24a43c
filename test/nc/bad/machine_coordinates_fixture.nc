; P-ERR-21618 machine_coordinates_fixture.nc line 4 column 1 '#ACS OFF': #ACS is not possible between #MCS ON and #MCS OFF
#ACS ON [1, 2, 3]
#MCS ON
#ACS OFF
M30
