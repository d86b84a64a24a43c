; P-ERR-20925 parameter_unset_computed.nc line 2 column 3 'X[P[3+4]]': parameter P7 has no value yet
X[P[3+4]]
M30
