%TOOLS
N10 G00 Z100
N20 T2 M6                     ; the magazine has two pockets to go
N30 M3 S1200                  ; waits for the door
N40 G00 X60
N50 T5                        ; turns the magazine, the program continues
N60 G01 X-60 F3000
N70 M5
N80 G00 Z100
N90 M6
N100 M3 S2000
N110 G01 X0 F3000
N120 M5
N130 M30
