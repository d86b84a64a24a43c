; P-ERR-21616 preset_without_axis.nc line 2 column 6 '#PSET': #PSET without an axis; its syntax is #PSET X10 Y20
#PSET
M30
