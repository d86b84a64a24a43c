; P-ERR-21019 cycle_of_unknown_subroutine.nc line 2 column 1 'LL CYCLE [NAME=NOWHERE]': unknown subroutine NOWHERE; known are: none
LL CYCLE [NAME=NOWHERE]
M30
