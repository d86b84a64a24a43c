(TF5200 spindle p.57: tapered thread at 73 degrees to Z, in diameters)
(Its second variant, N010 G33 Z90 X1 K5.0, has the pitch along Z: refused with 21663, from 45 degrees on I counts.)
(Its S1 is S100. It positions Y, too, which this lathe does not have, and calls "tapered thread" by its name with a blank.)
%L tapered_thread
N010 G33 Z90 X1 I5.0 (cut thread turn, reference I)
N020 G00 X72 (retract and move)
N030 Z105 (to start position)
N040 M29 (subroutine end)
%G33
N050 G00 X0 Z0
N060 G18
N070 G51 (select diameter programming)
N080 T5 D5 M03 S100 (select tool, start spindle; D1 in the manual)
N090 G00 X105 Z105 (start)
N100 G01 X100 F1000 (position at 1st cutting depth)
N110 LL tapered_thread (1st thread cut)
N120 M05 X150 Z200 (move to end position)
N130 M30 (program end)
