; P-ERR-21611 fixture_not_defined.nc line 3 column 1 '#ACS ON': #ACS 1 was not defined with #ACS DEF or ON before
#CS DEF [1,2,3]
#ACS ON
M30
