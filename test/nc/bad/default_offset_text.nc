; P-ERR-21435 default_offset_text.nc line 2 column 1 'V.G.NP_DEFAULT = "G54"': the channel has no zero offset G54; it has: 0 to 96
V.G.NP_DEFAULT = "G54"
M30
