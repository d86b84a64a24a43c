; P-ERR-21090 weight_above_100.nc line 2 column 19 'N10 G135 G136 X80 Y100.5 Z0': feedforward weight 100.5 % of axis Y is not within 0 ... 100 %
N10 G135 G136 X80 Y100.5 Z0
M30
