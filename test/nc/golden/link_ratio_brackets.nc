; machine X / three
; ratios in brackets of their own, with and without a ratio, by names and by numbers
N10 #SET AX LINK[1, [S2=S, 2, 1], [S3=S, -1, 2]]
N20 #ENABLE AX LINK[1]
N30 #DISABLE AX LINK[1]
N40 #AX LINK [NBR] [2, [11=6, 3, 4]]
N50 #AX LINK ON[2]
N60 #AX LINK OFF[2]
N70 #SET AX LINK[3, [S2=S], S3=S, 5, 4]
N80 #ENABLE AX LINK[3]
N90 M30
