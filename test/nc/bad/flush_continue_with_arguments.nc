; P-ERR-21076 flush_continue_with_arguments.nc line 2 column 1 '#FLUSH CONTINUE [1]': #FLUSH CONTINUE is written without arguments
#FLUSH CONTINUE [1]
M30
