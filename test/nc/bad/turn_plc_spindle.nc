; P-ERR-21724 turn_plc_spindle.nc line 4 column 5 'G18 G96 S100': G96 needs a spindle that the NC moves, the PLC controls S (P-CHAN-00069)
; machine X Y Z / plc
; facing X
G18 G96 S100
M30
