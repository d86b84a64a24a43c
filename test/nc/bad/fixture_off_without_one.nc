; P-ERR-21614 fixture_off_without_one.nc line 3 column 1 '#ACS OFF': #ACS OFF, but none is on
#CS ON [1,2]
#ACS OFF
M30
