; P-ERR-21561 stray_case.nc line 2 column 1 '$CASE 1': $CASE without $SWITCH before it
$CASE 1
M30
