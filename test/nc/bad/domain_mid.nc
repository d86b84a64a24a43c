; P-ERR-21422 domain_mid.nc line 2 column 7 'V.P.T=MID["abc",1,0]': MID of "abc", 1, 0 is not defined
V.P.T=MID["abc",1,0]
M30
