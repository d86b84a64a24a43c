; P-ERR-21613 system_too_deep.nc line 12 column 1 '#CS ON [1,2,3]': #CS ON at level 11, the limit is 10
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]
#CS ON [1,2,3]

M30
