; P-ERR-21435 spindle_of_variable_unknown.nc line 2 column 3 'X[V.SPDL_PROG.SPEED.S9]': the channel has no spindle S9; it has: S, S2
X[V.SPDL_PROG.SPEED.S9]
M30
