; P-ERR-21801 iso_o_word_in_line.nc line 3 column 7 'G0 X1 o100 call': 'O100 CALL': O words are not available; M98 calls a subroutine, M99 ends it
; dialect iso
G0 X1 o100 call
M30
