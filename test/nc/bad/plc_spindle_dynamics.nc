; P-ERR-21202 plc_spindle_dynamics.nc line 3 column 5 'N10 S[DEFAULT_DYNAMIC_DATA]': DEFAULT_DYNAMIC_DATA is not available for spindle S, which the PLC controls (P-CHAN-00069)
; machine X / plc
N10 S[DEFAULT_DYNAMIC_DATA]
M30
