; P-ERR-21202 plc_spindle_free_m.nc line 3 column 5 'N10 S[M8]': M08 is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 S[M8]
M30
