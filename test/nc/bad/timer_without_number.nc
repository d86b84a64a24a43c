; P-ERR-21076 timer_without_number.nc line 2 column 5 'N10 #TIMER READ SYN': #TIMER READ SYN is written with [ID=0] to [ID=127]
N10 #TIMER READ SYN
M30
