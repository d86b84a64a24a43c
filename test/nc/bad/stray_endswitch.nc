; P-ERR-21562 stray_endswitch.nc line 2 column 1 '$ENDSWITCH': $ENDSWITCH without $SWITCH before it
$ENDSWITCH
M30
