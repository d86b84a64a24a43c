; machine X / linked
N10 #ENABLE AX LINK              ; group 0: S2 follows S
N20 M3 S1000
N30 S1500 S3[M3 REV200]
N40 #SET AX LINK[1, S3=S]
N50 #AX LINK ON[1]
N60 M19 S.POS=90
N70 S[G74]
N80 #DISABLE AX LINK             ; group 1
N90 M4 M8 S700
N100 #SET AX LINK[1, 30=S2]
N110 #AX LINK OFF ALL
N120 S2[M3]                      ; with the speed that it got with the coupling
N130 #AX LINK[NBR][2, 11=6, S3=S]
N140 #ENABLE AX LINK[2]
N150 S[M5 M9]                    ; free functions are not for slaves
N160 M30
