; P-ERR-21565 stray_break.nc line 2 column 1 '$BREAK': $BREAK without a loop or $SWITCH before it
$BREAK
M30
