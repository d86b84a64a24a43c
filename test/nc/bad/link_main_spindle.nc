; P-ERR-21347 link_main_spindle.nc line 3 column 5 'N10 #ENABLE AX LINK': slave S is the main spindle
; machine X / wrongly_linked
N10 #ENABLE AX LINK
M30
