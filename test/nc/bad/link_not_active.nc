; P-ERR-21080 link_not_active.nc line 3 column 5 'N10 #DISABLE AX LINK': no coupling group is active
; machine X / three
N10 #DISABLE AX LINK
M30
