; P-ERR-21069 speed_in_no_gear.nc line 3 column 5 'N10 S8000': speed 8000 rpm of spindle S is in no gear stage (P-CHAN-00058, P-CHAN-00055): M40 50 to 560 rpm, M41 400 to 800 rpm, M42 700 to 3500 rpm, M43 3501 to 4000 rpm, M44 3800 to 5500 rpm, M45 5400 to 7000 rpm
; machine X / automatic
N10 S8000
M30
