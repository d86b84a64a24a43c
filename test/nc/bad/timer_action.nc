; P-ERR-21615 timer_action.nc line 2 column 8 '#TIMER STRT [ID=1]': 'STRT' is not available in #TIMER; its syntax is #TIMER START [ID=1], with START, STOP, READ or CLEAR
#TIMER STRT [ID=1]
M30
