; P-ERR-21648 tap_pitch_differs.nc line 2 column 20 'G63 Z-10 F260 S200 K1.25': feed 260 mm/min with speed 200 rpm makes a pitch of 1.3 mm, not 1.25 mm: it needs F250 (within 0.1 %, P-CHAN-90020)
G63 Z-10 F260 S200 K1.25
M30
