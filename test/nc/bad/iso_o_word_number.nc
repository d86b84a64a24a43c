; P-ERR-21801 iso_o_word_number.nc line 3 column 1 'O100 sub': 'O100 SUB': O words are not available; M98 calls a subroutine, M99 ends it
; dialect iso
O100 sub
M30
