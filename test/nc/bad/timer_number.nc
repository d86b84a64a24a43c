; P-ERR-21076 timer_number.nc line 2 column 1 '#TIMER START [ID=128]': #TIMER START is written with [ID=0] to [ID=127]
#TIMER START [ID=128]
M30
