; P-ERR-21672 thread_retract_c.nc line 3 column 17 '#THREAD RETRACT C5': C is not possible: a retract moves one axis of X, Y and Z, as in #THREAD RETRACT X-5, in the direction of the axis, or #THREAD RETRACT OFF or DEFAULT
; machine X Z C / S
#THREAD RETRACT C5
M30
