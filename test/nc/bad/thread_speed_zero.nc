; P-ERR-21665 thread_speed_zero.nc line 3 column 1 'G33 Z48 K1.5': spindle S does not turn (its speed is 0 rpm); G33 needs M03 or M04 with a speed above 0
M03 S0
G33 Z48 K1.5
M30
