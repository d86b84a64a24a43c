; P-ERR-21008 h_twice.nc line 2 column 4 'H1 H2': word H twice in one block: 1 and 2
H1 H2
M30
