; P-ERR-21596 argument_unread.nc line 2 column 39 'L CYCLE [NAME=g81.nc @P1=5 @P2=2 @P99=7]': G81.NC does not read parameter @P99; parameters that it reads: @P1, @P2
L CYCLE [NAME=g81.nc @P1=5 @P2=2 @P99=7]
M30
