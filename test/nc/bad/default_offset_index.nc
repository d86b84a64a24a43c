; P-ERR-21435 default_offset_index.nc line 2 column 1 'V.G.NP_DEFAULT = 97': the channel has no zero offset 97; it has: 0 to 96
V.G.NP_DEFAULT = 97
M30
