; machine X / automatic
N10 S650 M03       ; M41, stage 2
N20 S750
N30 S950           ; M42
N40 S1050
N50 S750           ; M42 holds it
N60 S500           ; bottom up: M40 comes before M41
N70 S350
N80 M41 S750
N90 M19 S20        ; no range has it
N100 M3 S650
N110 S[M4 REV500]
N120 S2[M3 REV9000]
N130 M5 S60
N140 M42
N150 S0
N160 M3
N170 M30
