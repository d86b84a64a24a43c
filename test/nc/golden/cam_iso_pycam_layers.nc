; dialect iso
;PYCAM-META-DATA: Filename: plate
;Estimated machine time: 1 minute
G40 (disable tool radius compensation)
G49 (disable tool length compensation)
G80 (cancel modal motion)
G54 (select coordinate system 1)
G90 (use absolute coordinates)
G21 (metric)
G64 P0.05 Q0.05
F300.00000
S1000.00000
T1 M6
M3 (start spindle)
G04 P3 (wait for the spindle)
G0 Z25.0000
G0 X0.0000 Y0.0000
G0 Z1.0000
G1 Z-0.5000
G1 X30.0000
G1 Y3.0000
G1 X0.0000
G1 Y6.0000
G1 X30.0000
G0 Z25.0000
G0 X0.0000 Y0.0000
G0 Z0.5000
G1 Z-1.0000
G1 X30.0000
G1 Y3.0000
G1 X0.0000
G1 Y6.0000
G1 X30.0000
G0 Z25.0000
M5 (stop spindle)
M2 (end program)
