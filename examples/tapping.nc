%TAPPING (TF5200 spindle 2.8.6: two threads M8 x 1.25, right-hand)
N05 G00 X0 Y0 Z5
N10 M19 S.POS=180 M3 S100 (the spindle stands at 180 degrees)
N20 G63 Z-15 F250 S200 (F = S times the pitch)
N30 G04 0.2
N40 Z5 S-200 (out of the thread)
N50 G01 X20 F3000 (G63 ends here)
N60 G63 Z-15 F250 S200 K1.25 (the pitch is compared with F and S)
N70 Z5 S-200
N80 M05 G01 X30 F1000
N90 M30
