; P-ERR-21615 thread_retract_behind.nc line 3 column 21 '#THREAD RETRACT OFF X5': 'X5' is not available in #THREAD RETRACT; its syntax is #THREAD RETRACT X-5, in the direction of the axis, or #THREAD RETRACT OFF or DEFAULT
; machine X Z / S
#THREAD RETRACT OFF X5
M30
