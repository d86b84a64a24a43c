; P-ERR-21035 radii_differ_absolute.nc line 4 column 18 'N30 G02 X0 Y-104 I0 J0 F600': radius 100 mm at the start and 104 mm at the target differ by 4 mm: the centre would have to move by 2.827884 mm, the limit is 2 mm (P-CHAN-00059 2 mm, P-CHAN-00060 5 % of radius 101.980405 mm)
N10 G161
N20 G00 X100
N30 G02 X0 Y-104 I0 J0 F600
M30
