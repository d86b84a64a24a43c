(TF5200 spindle p.56: M70 with two starts and a pitch of 1.5 mm, so the lead is 3 mm; X is the radius)
%G33_2
N10 G18 G90
N15 T5 D5 M03 S400
N20 G00 X36 Z105
N25 G01 X34.08 F1000
N30 G33 Z48 K3 (first start)
N35 G00 X36
N40 Z105
N45 G01 X34.08
N50 G33 Z48 K3 S.OFFSET=180 (second start)
N55 G00 X36
N60 M05 X75 Z200
N65 M30
