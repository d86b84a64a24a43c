; P-ERR-21072 gear_of_spindle_without_ranges.nc line 4 column 5 'N20 M41 S100': M41 is not a gear stage of spindle S (P-CHAN-00058, P-CHAN-00055): none
; machine X / gears
N10 #MAIN SPINDLE [S2]
N20 M41 S100
M30
