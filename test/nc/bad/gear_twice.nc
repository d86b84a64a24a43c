; P-ERR-21073 gear_twice.nc line 3 column 9 'N10 M40 M41 S450': gear stages M40 and M41 in one block
; machine X / gears
N10 M40 M41 S450
M30
