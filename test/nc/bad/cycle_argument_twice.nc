; P-ERR-21584 cycle_argument_twice.nc line 2 column 34 'L CYCLE [NAME=drill.nc @P1=5 @P1=6]': parameter @P1 twice in one call
L CYCLE [NAME=drill.nc @P1=5 @P1=6]
M30
