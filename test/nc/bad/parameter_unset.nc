; P-ERR-20925 parameter_unset.nc line 2 column 3 'X[P7]': parameter P7 has no value yet
X[P7]
M30
