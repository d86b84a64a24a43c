; P-ERR-120129 hsc_track_negative.nc line 2 column 42 '#HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=-1]': TRACK_DEV=-1 must be above 0
#HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=-1]
M30
