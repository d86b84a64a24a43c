; P-ERR-21084 link_ratio_word.nc line 3 column 5 'N10 #SET AX LINK[1, S2=S, 1, X]': ratio 1 / X of spindle S2: both must be numbers other than 0, their ratio within ±1e-06 ... ±1e+06
; machine X / three
N10 #SET AX LINK[1, S2=S, 1, X]
N90 M30
