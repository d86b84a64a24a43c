; P-ERR-21001 unexpected_character_unicode.nc line 2 column 13 'N10 G00 X10 Ÿ5': unexpected character 'Ÿ'
N10 G00 X10 Ÿ5
M30
