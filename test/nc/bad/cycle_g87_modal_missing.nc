; P-ERR-21598 cycle_g87_modal_missing.nc line 2 column 8 'G00 X1 G87[-10]': G87 calls g87.nc (P-CHAN-00167), which is in no search folder; put a program of this name beside the main one
G00 X1 G87[-10]
M30
