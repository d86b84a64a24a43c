; P-ERR-21018 return_in_main.nc line 3 column 5 'N20 M29': M29 ends a subroutine, but this is the main program
N10 G00 X10
N20 M29
N30 M30
