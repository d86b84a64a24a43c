; P-ERR-20797 thread_retract_axis.nc line 3 column 17 '#THREAD RETRACT Y5': axis Y is not in the machine; axes of this channel: X, Z
; machine X Z / S
#THREAD RETRACT Y5
M30
