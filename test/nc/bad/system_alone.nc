; P-ERR-21616 system_alone.nc line 2 column 4 '#CS': #CS without DEF, ON or OFF; its syntax is #CS DEF [1] [10, 0, 0, 0, 0, 90], #CS ON [10, 0, 0, 0, 0, 90], #CS ON [1], #CS OFF or #CS OFF ALL
#CS
M30
