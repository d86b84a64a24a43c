; P-ERR-21076 flush_with_arguments.nc line 2 column 1 '#FLUSH [1]': #FLUSH is written without arguments
#FLUSH [1]
M30
