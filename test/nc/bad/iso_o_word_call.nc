; P-ERR-21801 iso_o_word_call.nc line 3 column 1 'o<pocket> call [1]': 'O<POCKET> CALL': O words are not available; M98 calls a subroutine, M99 ends it
; dialect iso
o<pocket> call [1]
M30
