; P-ERR-21402 readable_unknown.nc line 2 column 3 'X[V.A.ABSOLUTE.X]': 'V.A.ABSOLUTE.X' is no function, constant or variable; did you mean V.A.ABS?
X[V.A.ABSOLUTE.X]
M30
