; P-ERR-21401 system_not_closed.nc line 2 column 8 '#CS ON [1,2': '[' is not closed in its line
#CS ON [1,2
M30
