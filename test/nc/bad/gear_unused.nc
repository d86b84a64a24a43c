; P-ERR-21072 gear_unused.nc line 3 column 5 'N10 M45 S6000': M45 is not a gear stage of spindle S (P-CHAN-00058, P-CHAN-00055): M40 50 to 560 rpm, M41 400 to 800 rpm, M42 700 to 3500 rpm, M43 3501 to 4000 rpm, M44 3800 to 5500 rpm
; machine X / gears
N10 M45 S6000
M30
