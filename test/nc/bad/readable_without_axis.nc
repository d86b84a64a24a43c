; P-ERR-21439 readable_without_axis.nc line 2 column 3 'X[V.A.ABS]': 'V.A.ABS' is not complete or has too much: it is written V.A.ABS.<axis>
X[V.A.ABS]
M30
