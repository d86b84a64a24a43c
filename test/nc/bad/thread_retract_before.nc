; P-ERR-21075 thread_retract_before.nc line 3 column 1 'G18 #THREAD RETRACT X5': #THREAD RETRACT must be alone in its block, not with 'G18'
; machine X Z / S
G18 #THREAD RETRACT X5
M30
