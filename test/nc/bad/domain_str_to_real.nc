; P-ERR-21422 domain_str_to_real.nc line 2 column 4 'P1=STR_TO_REAL["1,5"]': STR_TO_REAL of "1,5" is not defined
P1=STR_TO_REAL["1,5"]
M30
