; P-ERR-21501 if_not_closed.nc line 2 column 1 '$IF 1': $IF of line 2 has no $ENDIF before the end of main program
$IF 1
X5
M30
