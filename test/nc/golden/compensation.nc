; machine X Y Z B_AXIS / S
; friction compensation on and off, axis by axis
N5 G01 F600
N15 X[COMP ON FRICT] ;Activates X axis
N25 Y[COMP OFF FRICT] ;Deactivates Y axis
N35 X22 Y33 Z44
N45 X[COMP OFF FRICT] ;Deactivates X axis
N46 z[ comp	frict on ] B_AXIS[COMP ON FRICT] X0 M08 G135 S[G136=50]
N55 M30 X[COMP OFF FRICT] ;Program end
