; P-ERR-21014 no_main_program.nc line 4 column 1 'N20 M29': no main program
%L HOLE
N10 G00 X10
N20 M29
