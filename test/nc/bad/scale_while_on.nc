; P-ERR-21606 scale_while_on.nc line 3 column 1 '#SCALE Y2': #SCALE with factors while it is on; #SCALE OFF first
#SCALE ON X2
#SCALE Y2
M30
