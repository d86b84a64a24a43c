; P-ERR-21421 overflow_product.nc line 3 column 10 'P2=P1**15*P1**15': the result of * is beyond the range of numbers
P1=9999999999*9999999999
P2=P1**15*P1**15
M30
