; machine X / gears
N10 M41 S650 M03
N20 M41 S750
N30 M42 S950
N40 M42 S1050
N50 M41 S750
N60 M41 S500
N70 S450           ; M41 holds it
N80 M40            ; turns on in the new gear
N90 M05
N100 M42           ; only the gear, it stands
N110 S900
N120 M03
N130 M30
