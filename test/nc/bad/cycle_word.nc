; P-ERR-21591 cycle_word.nc line 2 column 24 'L CYCLE [NAME=drill.nc P1=5]': 'P1=5]' is not available in a cycle call; there are NAME=..., @P1=..., MODAL_MOVE and MODAL_BLOCK
L CYCLE [NAME=drill.nc P1=5]
M30
