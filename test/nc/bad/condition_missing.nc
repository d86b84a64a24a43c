; P-ERR-21573 condition_missing.nc line 2 column 4 '$IF': $IF without a condition or a value
$IF
$ENDIF
M30
