; P-ERR-21006 hash_command.nc line 2 column 5 'N10 #SLOPE [TYPE=STEP]': command '#SLOPE' is not available
N10 #SLOPE [TYPE=STEP]
M30
