; P-ERR-21017 end_missing.nc line 4 column 1 'N20 X20': main program MAIN has no M30 or M02 at its end
%MAIN
N10 G00 X10
N20 X20
