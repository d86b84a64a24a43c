; P-ERR-21615 machine_coordinates_word.nc line 2 column 9 '#MCS ON X10': 'X10' is not available in #MCS; its syntax is #MCS ON or #MCS OFF
#MCS ON X10
M30
