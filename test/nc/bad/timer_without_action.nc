; P-ERR-21616 timer_without_action.nc line 2 column 1 '#TIMER [ID=1]': #TIMER without an action; its syntax is #TIMER START [ID=1], with START, STOP, READ or CLEAR
#TIMER [ID=1]
M30
