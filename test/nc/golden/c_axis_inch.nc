; machine X Z C / c_axis
; in inch, and in the time of the block: the path on the face is that of X and C
N10 #CAX
N20 G00 X25.4 C0
N30 #FACE [X, C]
N40 G70 G01 C1 F10
N50 G03 X0 C2 I-1 J0
N60 G71 G93 G01 X-25.4 C50.8 F2
N70 G01 C25.4 F2
N80 #FACE OFF
N99 M30
