; P-ERR-21036 speed_missing.nc line 2 column 5 'N10 M03': M03 of spindle S without a speed: none was programmed before
N10 M03
M30
