; P-ERR-21427 variable_unknown.nc line 3 column 3 'X[V.P.DEPHT]': variable V.P.DEPHT was not declared and has no value; did you mean V.P.DEPTH?
V.P.DEPTH=5
X[V.P.DEPHT]
M30
