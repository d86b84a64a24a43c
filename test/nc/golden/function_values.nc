; machine X Y Z / S
(what the vendor's manual has as examples, without brackets)
N10 M52=-345
N20 P1 = 567 P2 = 345
N30 M54=P1
N40 M12=123 M10=321 M52=-345
N50 M63=-789 M52=-P2 M54=567
N60 H5=-345
N70 X10 H6=[P1 + 1] M8
N80 H5 M9=0
M30
