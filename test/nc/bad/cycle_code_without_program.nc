; P-ERR-21598 cycle_code_without_program.nc line 2 column 1 'G87[-10, 2]': G87 calls g87.nc (P-CHAN-00167), which is in no search folder; put a program of this name beside the main one
G87[-10, 2]
M30
