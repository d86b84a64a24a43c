; P-ERR-21672 thread_retract_two.nc line 3 column 20 '#THREAD RETRACT X5 Z2': Z is not possible: a retract moves one axis of X, Y and Z, as in #THREAD RETRACT X-5, in the direction of the axis, or #THREAD RETRACT OFF or DEFAULT
; machine X Z / S
#THREAD RETRACT X5 Z2
M30
