; P-ERR-21616 error_without_id.nc line 2 column 14 '#ERROR [RC=2]': #ERROR without ID; its syntax is #ERROR [ID=455 RC=2 PV1=5]
#ERROR [RC=2]
M30
