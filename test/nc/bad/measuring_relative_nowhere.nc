; P-ERR-21101 measuring_relative_nowhere.nc line 2 column 9 'N10 G91 G100 X0 F300': G100 goes nowhere: the axes are at the end of the measuring run already
N10 G91 G100 X0 F300
M30
