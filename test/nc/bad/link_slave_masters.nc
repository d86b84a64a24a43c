; P-ERR-21284 link_slave_masters.nc line 5 column 5 'N30 #ENABLE AX LINK[1]': slave S is master in the active coupling group 0
; machine X / linked
N10 #SET AX LINK[1, S=S3]
N20 #ENABLE AX LINK
N30 #ENABLE AX LINK[1]
M30
