; machine X Y Z / S S1 S2
; selection and weights of feedforward for axes and spindles; axis words of G136 are percent, never a motion
%FEEDFORWARD
N10 G01 X10 F600
N20 G135 (Select feedforward control; weighting) (for all axes 100%)
N30 G136 X80 Y95 Z0 (weighting; here, the Z axis has no feedforward control)
N40 X20
N50 G135 G136 X33.5
N60 G136 X0.25 G137
N70 g137 g00 x30
N80 G91 G136 Z100 F1200
N90 G01 X5 G135 M08
N100 G90 G136 Y50 T1 M03 S1000
N110 S[G135] (Activate feedforward control for S)
N120 S[G136=80] (Define weighting in %)
N130 S[G137] (Deactivate feedforward control)
N140 S2[G135 G136=90] ( at 90% weighting for S2)
N150 S2[G136=0] (Change weighting to 0%)
N160 S1[G135] (Activate with default weighting 100% for S1)
N170 S1[ g136 = 12.5 G137 ] S2[G0135] X40 S[REV500]
N180 G136X1G135Y2
N185 G136 X100.5
N187 S[G136=136]
N190 M30
