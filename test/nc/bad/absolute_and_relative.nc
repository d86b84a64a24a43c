; P-ERR-21012 absolute_and_relative.nc line 2 column 9 'N10 G90 G91 X10': G90 and G91 belong to one group (dimensions) and cannot be in one block
N10 G90 G91 X10
M30
