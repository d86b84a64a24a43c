; P-ERR-21050 tool_radius_compensation.nc line 4 column 5 'N20 G41 G01 X10 F100': G41 is not available yet: compensation of the tool radius
; tools milling
N10 T1 D1
N20 G41 G01 X10 F100
M30
