; P-ERR-21017 end_missing_empty.nc line 2 column 1 '%MAIN': main program MAIN has no M30 or M02 at its end
%MAIN
