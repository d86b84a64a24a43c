; P-ERR-21202 plc_spindle_homing.nc line 3 column 5 'N10 S[G74]': G74 is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 S[G74]
M30
