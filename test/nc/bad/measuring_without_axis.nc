; P-ERR-21100 measuring_without_axis.nc line 2 column 5 'N10 G100 F300': G100 without an axis: its axis words are the end of the measuring run
N10 G100 F300
M30
