; P-ERR-21001 unexpected_character.nc line 2 column 13 'N10 G00 X10 ? Y5': unexpected character '?'
N10 G00 X10 ? Y5
M30
