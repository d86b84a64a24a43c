; P-ERR-20180 link_unknown.nc line 3 column 5 'N10 #SET AX LINK[1, S1=S]': spindle S1 does not belong to this channel; its spindles are: S, S2, S3
; machine X / three
N10 #SET AX LINK[1, S1=S]
M30
