; P-ERR-21598 cycle_code_without_program.nc line 2 column 1 'G84[-10, 2]': G84 calls g84.nc (P-CHAN-00164), which is in no search folder; put a program of this name beside the main one
G84[-10, 2]
M30
