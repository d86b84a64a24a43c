; P-ERR-21542 cycle_code_and_words.nc line 2 column 13 'G81[-10, 2] X5': 'X5' after a subroutine call
G81[-10, 2] X5
M30
