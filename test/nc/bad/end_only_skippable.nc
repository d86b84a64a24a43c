; P-ERR-21017 end_only_skippable.nc line 3 column 1 '/N20 M30': main program has no M30 or M02 at its end
N10 G00 X10
/N20 M30
