; P-ERR-21075 command_not_alone.nc line 3 column 5 'N10 X10 #EXPL SYN': #EXPL SYN must be alone in its block, not with 'X10'
; machine X / three
N10 X10 #EXPL SYN
M30
