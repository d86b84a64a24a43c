; P-ERR-21759 cax_weight.nc line 4 column 6 'G136 C50': feedforward and compensation of axis C: its controller is that of spindle S
; machine X Z C / c_axis
#CAX
G136 C50
M30
