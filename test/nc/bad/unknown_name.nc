; P-ERR-21002 unknown_name.nc line 2 column 5 'N10 HELP': unknown word 'HELP'
N10 HELP
M30
