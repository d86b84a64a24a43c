; P-ERR-21615 system_action.nc line 2 column 5 '#CS START [1,2,3]': 'START' is not available in #CS; its syntax is #CS DEF [1] [10, 0, 0, 0, 0, 90], #CS ON [10, 0, 0, 0, 0, 90], #CS ON [1], #CS OFF or #CS OFF ALL
#CS START [1,2,3]
M30
