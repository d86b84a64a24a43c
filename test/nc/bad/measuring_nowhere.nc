; P-ERR-21101 measuring_nowhere.nc line 3 column 5 'N20 G100 X5': G100 goes nowhere: the axes are at the end of the measuring run already
N10 G01 X5 F300
N20 G100 X5
M30
