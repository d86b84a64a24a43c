; P-ERR-20721 message_values_too_many.nc line 2 column 7 '#MSG ["%d", 5, 6]': the text needs 1 value for its %d, %f and %s, not 2
#MSG ["%d", 5, 6]
M30
