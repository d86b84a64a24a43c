; P-ERR-21076 link_syntax_enable.nc line 3 column 5 'N10 #ENABLE AX LINK[1, 2]': #ENABLE AX LINK is written #ENABLE AX LINK [group]
; machine X / three
N10 #ENABLE AX LINK[1, 2]
M30
