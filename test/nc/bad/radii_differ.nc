; P-ERR-21035 radii_differ.nc line 2 column 16 'N10 G03 X20 Y0 I5 J0 F600': radius 5 mm at the start and 15 mm at the target differ by 10 mm: the centre would have to move by 5 mm, the limit is 0.5 mm (P-CHAN-00059 2 mm, P-CHAN-00060 5 % of radius 10 mm)
N10 G03 X20 Y0 I5 J0 F600
M30
