; P-ERR-21094 spindle_weight_missing.nc line 2 column 12 'N10 S[G135 G136]': G136 of spindle S without a weight in percent, as in G136=80
N10 S[G135 G136]
M30
