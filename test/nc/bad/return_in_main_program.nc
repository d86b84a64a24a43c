; P-ERR-21018 return_in_main_program.nc line 2 column 1 '$RETURN': $RETURN ends a subroutine, but this is the main program
$RETURN
M30
