; P-ERR-21663 thread_pitch_of_the_face.nc line 4 column 15 'G33 Z15 X49.5 K5.0': X moves most in this thread (X 49.5 mm, Z 15 mm), so its pitch is programmed with I, not with K
; the K5.0 line of TF5200 spindle p.57: 73 deg to Z
M03 S400
G33 Z15 X49.5 K5.0
M30
