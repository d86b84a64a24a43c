; P-ERR-21595 error_reaction.nc line 2 column 17 '#ERROR [ID=5 RC=1]': #ERROR RC=1: there are 0 (warning), 2 (error) and 7 (fatal error)
#ERROR [ID=5 RC=1]
M30
