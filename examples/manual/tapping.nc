%TAPPING (TF5200 spindle p.52: right-hand thread, pitch 1.25 mm, depth 50 mm; F = 200 rpm * 1.25 mm = 250 mm/min)
(The manual prints no block numbers and no end of the program.)
N10 G01 F2000 G90 X0 Y0 Z0 (position axes)
N20 M19 S.POS=0 M3 S100 (stop and position spindle)
N30 G63 Z-50 F250 S200 (tap)
N40 Z0 S-200 (retract from threaded bore)
N50 G01 F1000 X100 (reposition, deselect tapping)
N60 M30
