; P-ERR-21615 error_option.nc line 2 column 14 '#ERROR [ID=5 PV6=1]': 'PV6=1' is not available in #ERROR; its syntax is #ERROR [ID=455 RC=2 PV1=5]
#ERROR [ID=5 PV6=1]
M30
