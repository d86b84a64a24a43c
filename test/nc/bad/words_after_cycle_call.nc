; P-ERR-21542 words_after_cycle_call.nc line 2 column 31 'L CYCLE [NAME=drill.nc @P1=5] X5': 'X5' after a subroutine call
L CYCLE [NAME=drill.nc @P1=5] X5
M30
