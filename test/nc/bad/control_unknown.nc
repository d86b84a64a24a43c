; P-ERR-21566 control_unknown.nc line 2 column 1 '$FORALL P1': $FORALL is no control statement; did you mean $FOR?
$FORALL P1
M30
