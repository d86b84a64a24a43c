; P-ERR-21024 centre_and_radius.nc line 2 column 13 'N10 G02 X10 I5 R5 F600': circle centre (I) and radius (R) in one block
N10 G02 X10 I5 R5 F600
M30
