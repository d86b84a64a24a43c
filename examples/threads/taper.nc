(TF5200 spindle p.57: a steep taper with the pitch along X, 73 deg to Z; X is the radius)
%L tapered_thread
N010 G33 Z90 X0.5 I5.0 (cut the thread, pitch along X)
N020 G00 X36
N030 Z105
N040 M29
%G33
N060 G18 G90
N080 T5 D5 M03 S100
N090 G00 X52.5 Z105
N100 G01 X50 F1000 (first depth)
N110 LL tapered_thread
N120 M05 X75 Z200
N130 M30
