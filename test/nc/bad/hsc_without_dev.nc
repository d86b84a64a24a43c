; P-ERR-21114 hsc_without_dev.nc line 2 column 1 '#HSC ON [BSPLINE TRACK_DEV=1]': #HSC ON without PATH_DEV, and the machine file has none (P-CHAN-90014); e.g. #HSC ON [BSPLINE PATH_DEV=0.01]
#HSC ON [BSPLINE TRACK_DEV=1]
M30
