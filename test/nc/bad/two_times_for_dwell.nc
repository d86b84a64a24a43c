; P-ERR-21005 two_times_for_dwell.nc line 2 column 11 'N10 G04 1 2': number '2' without a letter; only G04 takes a bare number
N10 G04 1 2
M30
