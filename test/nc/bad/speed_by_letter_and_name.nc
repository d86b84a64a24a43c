; P-ERR-21037 speed_by_letter_and_name.nc line 3 column 10 'N10 S100 SPINDLE=200': spindle SPINDLE is programmed twice in one block
; machine X / SPINDLE
N10 S100 SPINDLE=200
M30
