; P-ERR-21033 arc_without_centre_modal.nc line 3 column 1 'N20 Z10': G03 without a centre (K, I) and without a radius (R)
N10 G18 G03 F600
N20 Z10
M30
