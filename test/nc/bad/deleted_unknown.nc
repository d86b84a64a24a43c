; P-ERR-20932 deleted_unknown.nc line 3 column 9 '#DELETE V.P.DEPHT': #DELETE of V.P.DEPHT, which is not there; did you mean V.P.DEPTH?
V.P.DEPTH=1
#DELETE V.P.DEPHT
M30
