; P-ERR-20160 m_not_built_yet.nc line 2 column 5 'N10 M19 S200': unknown M function M19
N10 M19 S200
M30
