; P-ERR-21399 preset_without_value.nc line 2 column 8 '#PSET X': the expression ends where a value is needed
#PSET X
M30
