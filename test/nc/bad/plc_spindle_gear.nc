; P-ERR-21202 plc_spindle_gear.nc line 3 column 5 'N10 M41': M41 is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 M41
M30
