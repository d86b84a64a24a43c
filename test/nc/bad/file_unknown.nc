; P-ERR-21586 file_unknown.nc line 2 column 1 'L mill.nc': no program MILL.NC in the search folders
L mill.nc
M30
