; P-ERR-21435 timer_variable.nc line 2 column 6 'P1 = V.G.TIMER[128]': the channel has no timer 128; it has: 0 to 127
P1 = V.G.TIMER[128]
M30
