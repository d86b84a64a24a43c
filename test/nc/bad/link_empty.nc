; P-ERR-21079 link_empty.nc line 3 column 5 'N10 #ENABLE AX LINK[2]': coupling group 2 has no coupled pair
; machine X / three
N10 #ENABLE AX LINK[2]
M30
