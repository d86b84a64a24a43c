; P-ERR-21604 system_turns_a_missing_axis.nc line 3 column 1 '#CS ON [0,0,0,0,0,90]': #CS moves axis Y, which this channel does not have
; machine X Z / S
#CS ON [0,0,0,0,0,90]
M30
