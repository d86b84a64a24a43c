; P-ERR-21347 main_spindle_is_slave.nc line 4 column 5 'N20 #MAIN SPINDLE [S2]': slave S2 is the main spindle
; machine X / linked
N10 #ENABLE AX LINK[0]
N20 #MAIN SPINDLE [S2]
M30
