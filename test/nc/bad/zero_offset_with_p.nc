; P-ERR-21579 zero_offset_with_p.nc line 2 column 5 'G54 P2': P2 without '=' and a value; zero offsets by number are written G159=2
G54 P2
M30
