; P-ERR-21080 link_not_active_number.nc line 4 column 5 'N20 #DISABLE AX LINK[1]': coupling group 1 is not active
; machine X / linked
N10 #ENABLE AX LINK
N20 #DISABLE AX LINK[1]
M30
