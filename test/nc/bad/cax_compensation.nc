; P-ERR-21759 cax_compensation.nc line 4 column 5 'X10 C[COMP ON FRICT]': feedforward and compensation of axis C: its controller is that of spindle S
; machine X Z C / c_axis
#CAX
X10 C[COMP ON FRICT]
M30
