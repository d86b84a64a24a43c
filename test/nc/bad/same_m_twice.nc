; P-ERR-21042 same_m_twice.nc line 2 column 9 'N10 M08 M08': M08 twice in one block
N10 M08 M08
M30
