; P-ERR-21569 default_twice.nc line 4 column 1 '$DEFAULT': second $DEFAULT of one $SWITCH, the first is in line 3
$SWITCH 1
$DEFAULT
$DEFAULT
$ENDSWITCH
M30
