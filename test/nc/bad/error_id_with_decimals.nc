; P-ERR-21423 error_id_with_decimals.nc line 2 column 12 '#ERROR [ID=1.5]': ID needs an integer, not 1.5
#ERROR [ID=1.5]
M30
