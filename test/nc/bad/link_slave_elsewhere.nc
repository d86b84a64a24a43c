; P-ERR-21283 link_slave_elsewhere.nc line 5 column 5 'N30 #ENABLE AX LINK[1]': slave S2 is slave in the active coupling group 0 already
; machine X / linked
N10 #SET AX LINK[1, S2=S3]
N20 #ENABLE AX LINK
N30 #ENABLE AX LINK[1]
M30
