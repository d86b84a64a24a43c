; P-ERR-21032 face_centre_word.nc line 6 column 16 'G02 X10 C0 I-5 K0 F100': centre word K is not in the plane #FACE [X, C] (XC)
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE [X, C]
G02 X10 C0 I-5 K0 F100
M30
