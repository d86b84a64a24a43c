; machine X Z C / c_axis
; tools milling
; the radius on the face and on the cylinder; F of a corner is that of its line
N5 D2
N10 #CAX
N20 G00 X30 C0 Z5
N30 #FACE [X, C]
N40 G41 G01 X20 C-10 F1000
N50 C10
N60 G03 X10 C20 I-10 J0
N70 G01 X-5 Z-1
N75 G91 G01 C10
N80 G90 G40 X-20 C40
N90 #FACE OFF
N100 #CYL [Z, C, X20]
N110 G42 G01 Z10 C5 F500
N120 Z30
N130 C20
N140 G40 Z40
N150 #CYL OFF
N160 M30
