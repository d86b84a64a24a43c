; P-ERR-21077 link_group_negative.nc line 3 column 5 'N10 #ENABLE AX LINK[-1]': coupling group -1 must be a number from 0 to 3
; machine X / three
N10 #ENABLE AX LINK[-1]
M30
