; P-ERR-20721 message_values_missing.nc line 2 column 7 '#MSG ["%d and %f", 5]': the text needs 2 values for its %d, %f and %s, not 1
#MSG ["%d and %f", 5]
M30
