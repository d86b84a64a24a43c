; P-ERR-20244 stray_continue.nc line 4 column 1 '$CONTINUE': $CONTINUE without a loop before it
$SWITCH 1
$CASE 1
$CONTINUE
$ENDSWITCH
M30
