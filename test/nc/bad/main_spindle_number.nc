; P-ERR-21306 main_spindle_number.nc line 3 column 5 'N10 #MAIN SPINDLE [7]': no spindle of this channel has the logical axis number 7; known are: 6, 11, 30
; machine X / three
N10 #MAIN SPINDLE [7]
M30
