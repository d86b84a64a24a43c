; P-ERR-20216 stray_elseif.nc line 2 column 1 '$ELSEIF P1': $ELSEIF without $IF before it
$ELSEIF P1
M30
