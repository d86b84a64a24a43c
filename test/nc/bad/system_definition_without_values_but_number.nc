; P-ERR-21616 system_definition_without_values_but_number.nc line 2 column 12 '#CS DEF [1]': #CS without values; its syntax is #CS DEF [1] [10, 0, 0, 0, 0, 90], #CS ON [10, 0, 0, 0, 0, 90], #CS ON [1], #CS OFF or #CS OFF ALL
#CS DEF [1]
M30
