; P-ERR-20477 link_slave_and_master.nc line 3 column 5 'N10 #SET AX LINK[1, S2=S, S3=S2]': spindle S2 cannot be slave and master in one coupling group
; machine X / three
N10 #SET AX LINK[1, S2=S, S3=S2]
M30
