; P-ERR-21006 timer_action.nc line 2 column 1 '#TIMER RESET [ID=1]': command '#TIMER' is not available
#TIMER RESET [ID=1]
M30
