; P-ERR-21599 fault_in_a_called_file.nc line 2 column 1 'L drill.nc': DRILL.NC does not give @P1, which drill.nc reads in line 14
L drill.nc
M30
