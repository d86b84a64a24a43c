; machine X Y Z / S
; tools milling
; #TOOL DATA as the D word, #TOOL PREP as the T word, with expressions and gaps
N10 #TOOL PREP [1]
N20 #TOOL DATA [1, 0, 0]
N30 G01 Z0 F600
N40 P1 = 1
N50 #TOOL DATA [P1 + 1, , ]
N60 G01 Z0
N70 #MSG ["D%d", V.G.D_AKT]
N80 #TOOL PREP [3, 0]
N90 #TOOL DATA [0]
N95 Z0
M30
