; P-ERR-21079 link_empty_default.nc line 3 column 5 'N10 #ENABLE AX LINK': coupling group 0 has no coupled pair
; machine X / three
N10 #ENABLE AX LINK
M30
