; P-ERR-20925 drill.nc line 14 column 25 'LL CYCLE [NAME=PECK @P1=@P1]': parameter @P1 has no value yet
L drill.nc
M30
