; P-ERR-21616 thread_retract_missing.nc line 3 column 16 '#THREAD RETRACT': #THREAD RETRACT without an axis with its way; its syntax is #THREAD RETRACT X-5, in the direction of the axis, or #THREAD RETRACT OFF or DEFAULT
; machine X Z / S
#THREAD RETRACT
M30
