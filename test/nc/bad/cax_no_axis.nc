; P-ERR-21740 cax_no_axis.nc line 2 column 1 '#CAX': #CAX without a name of the axis in the machine file (P-CHAN-00010)
#CAX
M30
