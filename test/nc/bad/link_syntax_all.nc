; P-ERR-21076 link_syntax_all.nc line 3 column 5 'N10 #AX LINK OFF ALL [1]': #AX LINK OFF ALL is written without arguments
; machine X / three
N10 #AX LINK OFF ALL [1]
M30
