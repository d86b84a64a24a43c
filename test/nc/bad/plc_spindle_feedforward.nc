; P-ERR-21202 plc_spindle_feedforward.nc line 3 column 7 'N10 S[G135]': G135 is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 S[G135]
N90 M30
