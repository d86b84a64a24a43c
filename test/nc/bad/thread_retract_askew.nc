; P-ERR-21673 thread_retract_askew.nc line 7 column 1 'G33 Z80 K1.5': the retract of #THREAD RETRACT would be askew: X, Y and Z are rotated
; machine X Z / S
G18
#THREAD RETRACT X5
M03 S100
#ROTATION ON [ANGLE=10]
G33 Z80 K1.5
M30
