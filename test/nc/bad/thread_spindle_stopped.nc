; P-ERR-21665 thread_spindle_stopped.nc line 4 column 1 'G33 Z48 K1.5': spindle S does not turn (the program has stopped it); G33 needs M03 or M04 with a speed above 0
M03 S400
M05
G33 Z48 K1.5
M30
