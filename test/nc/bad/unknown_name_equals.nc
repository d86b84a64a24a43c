; P-ERR-21002 unknown_name_equals.nc line 2 column 5 'N10 LENGTH=5': unknown word 'LENGTH=5'
N10 LENGTH=5
M30
