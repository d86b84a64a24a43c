; P-ERR-21075 command_not_alone_behind.nc line 3 column 24 'N10 #MAIN SPINDLE [S2] M3 S100': #MAIN SPINDLE must be alone in its block, not with 'M3 S100'
; machine X / three
N10 #MAIN SPINDLE [S2] M3 S100
M30
