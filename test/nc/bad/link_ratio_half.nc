; P-ERR-21076 link_ratio_half.nc line 3 column 5 'N10 #SET AX LINK[1, S2=S, 2, S3=S]': #SET AX LINK is written #SET AX LINK [group, slave=master, ...] or [group, [slave=master, num, den], ...]
; machine X / three
N10 #SET AX LINK[1, S2=S, 2, S3=S]
N90 M30
