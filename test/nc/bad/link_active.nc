; P-ERR-20472 link_active.nc line 5 column 5 'N30 #SET AX LINK[1, S3=S]': coupling group 1 is active and cannot be redefined
; machine X / three
N10 #SET AX LINK[1, S2=S]
N20 #ENABLE AX LINK[1]
N30 #SET AX LINK[1, S3=S]
M30
