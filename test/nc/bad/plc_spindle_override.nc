; P-ERR-21202 plc_spindle_override.nc line 3 column 10 'N10 G167 S100': G167 is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 G167 S100
M30
