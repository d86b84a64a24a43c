; P-ERR-21723 turn_limit_missing.nc line 3 column 5 'G18 G196': G196 without a speed, as in G196 S2500 or G196=2500
; facing X
G18 G196
M30
