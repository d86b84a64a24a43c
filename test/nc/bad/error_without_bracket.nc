; P-ERR-21615 error_without_bracket.nc line 2 column 8 '#ERROR 5': '5' is not available in #ERROR; its syntax is #ERROR [ID=455 RC=2 PV1=5]
#ERROR 5
M30
