; P-ERR-21742 cax_off_word.nc line 3 column 5 'G01 C10 F100': C is the main spindle; #CAX makes it an axis of the path
; machine X Z C / c_axis
G01 C10 F100
M30
