; P-ERR-21202 plc_spindle_link.nc line 3 column 5 'N10 #SET AX LINK[1, S2=S]': #SET AX LINK is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 #SET AX LINK[1, S2=S]
N90 M30
