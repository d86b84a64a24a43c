; P-ERR-21285 link_master_follows.nc line 5 column 5 'N30 #ENABLE AX LINK[1]': master S2 is slave in the active coupling group 0
; machine X / linked
N10 #SET AX LINK[1, S3=S2]
N20 #ENABLE AX LINK
N30 #ENABLE AX LINK[1]
M30
