; P-ERR-21597 call_with_bracket.nc line 2 column 10 'L g81.nc [@P1=1]': parameters need a cycle call: L CYCLE [NAME=G81.NC @P1=...]
L g81.nc [@P1=1]
M30
