; P-ERR-21725 main_spindle_cutting_speed.nc line 8 column 1 '#MAIN SPINDLE [S2]': #MAIN SPINDLE while the cutting speed is constant (G96): G97 before it
; machine X Z / three
; facing X
G18 G00 X50
M3 S100
G96 S100
#MAIN SPINDLE [S1]
#MAIN SPINDLE [S2]
M30
