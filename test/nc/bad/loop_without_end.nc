; P-ERR-21583 loop_without_end.nc line 7 column 1 '$ENDWHILE': a loop without an end: the program comes back with the same positions and values each time
P1 = 0
$WHILE P1 < 3
$FOR P2 = 1, 3, 1
G00 X=P2
$ENDFOR
$ENDWHILE
M30
