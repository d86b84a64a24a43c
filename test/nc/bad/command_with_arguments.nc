; P-ERR-21076 command_with_arguments.nc line 3 column 5 'N10 #EXPL SYN [1]': #EXPL SYN is written without arguments
; machine X / three
N10 #EXPL SYN [1]
M30
