; P-ERR-21441 value_of_an_offset_too_large.nc line 2 column 1 'V.G.NP[1].V.X=DEXP[12]': value 1e+12 of the offset is not within -214748 ... 214748
V.G.NP[1].V.X=DEXP[12]
M30
