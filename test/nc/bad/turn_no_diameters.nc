; P-ERR-21720 turn_no_diameters.nc line 3 column 5 'G18 G51': G51 would have no effect: diameters of axis X are off for G90 (P-AXIS-00058) and G91 (P-AXIS-00059)
; facing off
G18 G51
M30
