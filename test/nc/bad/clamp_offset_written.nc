; P-ERR-21408 clamp_offset_written.nc line 2 column 1 'V.A.PZV.X = 5': V.A.PZV can be read only
V.A.PZV.X = 5
M30
