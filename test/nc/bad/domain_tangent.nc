; P-ERR-21422 domain_tangent.nc line 2 column 4 'P1=TAN[90]': TAN of 90 is not defined
P1=TAN[90]
M30
