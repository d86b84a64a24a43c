; P-ERR-21801 iso_o_word_sub.nc line 3 column 1 'o<pocket> sub': 'O<POCKET> SUB': O words are not available; M98 calls a subroutine, M99 ends it
; dialect iso
o<pocket> sub
M30
