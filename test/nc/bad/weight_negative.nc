; P-ERR-21090 weight_negative.nc line 2 column 10 'N10 G136 X-1': feedforward weight -1 % of axis X is below 0 %
N10 G136 X-1
M30
