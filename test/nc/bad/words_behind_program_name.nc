; P-ERR-21016 words_behind_program_name.nc line 2 column 7 '%MAIN G00 X10': 'G00 X10' is not a program name
%MAIN G00 X10
M30
