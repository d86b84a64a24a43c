; P-ERR-21202 plc_spindle_weight.nc line 3 column 7 'N10 S[G136=80]': G136 is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 S[G136=80]
N90 M30
