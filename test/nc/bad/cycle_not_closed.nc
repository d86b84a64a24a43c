; P-ERR-21401 cycle_not_closed.nc line 2 column 9 'L CYCLE [NAME=drill.nc @P1=5': '[' is not closed in its line
L CYCLE [NAME=drill.nc @P1=5
M30
