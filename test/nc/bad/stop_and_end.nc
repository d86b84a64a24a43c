; P-ERR-21012 stop_and_end.nc line 2 column 9 'N10 M00 M30': M00 and M30 belong to one group (program flow) and cannot be in one block
N10 M00 M30
