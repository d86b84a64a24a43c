; P-ERR-21611 system_never_defined.nc line 2 column 1 '#CS ON': #CS 1 was not defined with #CS DEF or ON before
#CS ON
M30
