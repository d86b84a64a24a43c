; P-ERR-21090 weight_above_100_spindle.nc line 2 column 12 'N10 S[G135 G136=101]': feedforward weight 101 % of spindle S is not within 0 ... 100 %
N10 S[G135 G136=101]
M30
