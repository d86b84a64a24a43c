; P-ERR-20223 stray_default.nc line 2 column 1 '$DEFAULT': $DEFAULT without $SWITCH before it
$DEFAULT
M30
