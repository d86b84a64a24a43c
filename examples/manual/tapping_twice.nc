%Tapping_G63 (TF5200 spindle p.52: two holes with a pitch of 1.5 mm)
(The manual has G91 in N10. A tap of 50 mm would be retracted by 100 mm then, half of that turning in the air:)
(absolute positions are meant. N05 has neither G01 nor a feed, so it is rapid traverse.)
N05 G00 X0 Y0 Z0
N10 G90 Z100
N20 M19 S.POS180 M3 S100 (position spindle)
N30 G63 Z-50 F300 S200 (tap)
N40 Z100 S-200 (retract from threaded bore)
N50 G01 X200 F3000 (reposition, deselect tapping)
N60 G63 Z-70 F300 S200 (tap)
N70 Z100 S-200 (retract from threaded bore)
N80 M05 G01 X300 F1000
N90 M30
