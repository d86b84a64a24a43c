; P-ERR-21611 system_not_defined.nc line 2 column 1 '#CS ON [3]': #CS 3 was not defined with #CS DEF or ON before
#CS ON [3]
M30
