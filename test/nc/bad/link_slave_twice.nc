; P-ERR-20476 link_slave_twice.nc line 3 column 5 'N10 #SET AX LINK[1, S3=S, S3=S2]': spindle S3 is slave of two masters
; machine X / three
N10 #SET AX LINK[1, S3=S, S3=S2]
M30
