; P-ERR-21054 macro_definition.nc line 2 column 1 '"RELPOS" = "G01 G91 X10 F100"': "RELPOS" is no word: texts are values of expressions, macros are not available
"RELPOS" = "G01 G91 X10 F100"
M30
