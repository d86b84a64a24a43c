; P-ERR-20925 argument_unset.nc line 2 column 3 'X[@P1]': parameter @P1 has no value yet
X[@P1]
M30
