; P-ERR-21616 scale_alone.nc line 2 column 7 '#SCALE': #SCALE without ON, OFF or factors; its syntax is #SCALE X2 Y2, #SCALE ON, #SCALE ON X2 Y2 or #SCALE OFF
#SCALE
M30
