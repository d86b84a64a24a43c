; P-ERR-21400 rotation_value_missing.nc line 2 column 21 '#ROTATION ON [ANGLE=]': an expression needs a value here, not ']'
#ROTATION ON [ANGLE=]
M30
