; P-ERR-21586 cycle_code_without_program.nc line 2 column 1 'G84[-10, 2]': no program G84.NC in the search folders
G84[-10, 2]
M30
