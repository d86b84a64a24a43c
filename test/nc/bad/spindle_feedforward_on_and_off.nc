; P-ERR-21012 spindle_feedforward_on_and_off.nc line 2 column 12 'N10 S[G135 G137]': G135 and G137 belong to one group (feedforward) and cannot be in one block
N10 S[G135 G137]
M30
