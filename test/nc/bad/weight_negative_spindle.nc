; P-ERR-21090 weight_negative_spindle.nc line 2 column 8 'N10 S2[G136=-0.1]': feedforward weight -0.1 % of spindle S2 is below 0 %
N10 S2[G136=-0.1]
M30
