; P-ERR-21615 thread_retract_word.nc line 3 column 17 '#THREAD RETRACT ON': 'ON' is not available in #THREAD RETRACT; its syntax is #THREAD RETRACT X-5, in the direction of the axis, or #THREAD RETRACT OFF or DEFAULT
; machine X Z / S
#THREAD RETRACT ON
M30
