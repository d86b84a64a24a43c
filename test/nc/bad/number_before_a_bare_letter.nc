; P-ERR-21005 number_before_a_bare_letter.nc line 2 column 1 '54 P': number '54' without a letter; only G04 takes a bare number
54 P
M30
