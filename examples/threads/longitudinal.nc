(TF5200 spindle p.56: M70x1.5 in four cuts and a last one without infeed; X is the radius, thread depth 0.92 mm)
%L longit_thread
N100 G33 Z48 K1.5 (cut the thread)
N110 G00 X36 (retract and move)
N120 Z105 (to the start position)
N130 M29
%G33
N10 G18 G90
N15 T5 D5 M03 S400 (select tool, start spindle)
N20 G00 X36 Z105 (approach)
N25 G01 X34.77 F1000 (first depth)
N30 LL longit_thread
N35 G01 X34.54
N40 LL longit_thread
N45 G01 X34.31
N50 LL longit_thread
N55 G01 X34.08 (final depth)
N60 LL longit_thread
N65 G01 X34.08
N70 LL longit_thread (empty cut)
N80 M05 X75 Z200
N85 M30
