; P-ERR-21035 iso_arc_radii_differ.nc line 3 column 8 'G2 X10 I4 F100': radius 4 mm at the start and 6 mm at the target differ by 2 mm: the centre would have to move by 1 mm, the limit is 0.25 mm (P-CHAN-00059 2 mm, P-CHAN-00060 5 % of radius 5 mm)
; dialect iso
G2 X10 I4 F100
M30
