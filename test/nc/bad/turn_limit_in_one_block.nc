; P-ERR-21722 turn_limit_in_one_block.nc line 4 column 1 'G196 G96 S2500': G196 S2500 must be in a block before G96; beside G96 it is written G196=2500
; facing X
G18 M03 S100
G196 G96 S2500
M30
