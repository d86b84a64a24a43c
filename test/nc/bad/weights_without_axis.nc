; P-ERR-21091 weights_without_axis.nc line 2 column 10 'N10 G135 G136 F600': G136 without an axis: axis words are its weights in percent
N10 G135 G136 F600
M30
