; P-ERR-20155 spindle_m_twice.nc line 2 column 11 'N10 S2[M3 M4 REV100]': M3 and M4 for spindle S2 in one block
N10 S2[M3 M4 REV100]
M30
