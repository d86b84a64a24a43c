; P-ERR-21441 value_of_a_command_too_large.nc line 2 column 9 '#CS ON [DEXP[12]]': value 1000000000000 of the command is not within -999999999 ... 999999999
#CS ON [DEXP[12]]
M30
