; P-ERR-21427 local_variable_of_caller.nc line 3 column 3 'X[V.L.A]': variable V.L.A was not declared and has no value
%L UP
X[V.L.A]
M29
%MAIN
V.L.A=5
LL UP
M30
