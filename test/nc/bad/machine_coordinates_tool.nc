; P-ERR-21621 machine_coordinates_tool.nc line 2 column 9 '#MCS ON [EX TOOL]': #MCS ON [EX TOOL] is not available yet
#MCS ON [EX TOOL]
M30
