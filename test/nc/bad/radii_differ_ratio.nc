; P-ERR-21035 radii_differ_ratio.nc line 3 column 16 'N20 G03 X0 Y11 I-10 J0 F600': radius 10 mm at the start and 11 mm at the target differ by 1 mm: the centre would have to move by 0.706306 mm, the limit is 0.524407 mm (P-CHAN-00059 2 mm, P-CHAN-00060 5 % of radius 10.488142 mm)
N10 G00 X10 Y0
N20 G03 X0 Y11 I-10 J0 F600
M30
