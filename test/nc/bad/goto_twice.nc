; P-ERR-21572 goto_twice.nc line 3 column 16 '$IF 0 $GOTO N5 $GOTO N5': '$GOTO' after $GOTO: it must be alone in its block
N5: X1
$IF 0 $GOTO N5 $GOTO N5
M30
